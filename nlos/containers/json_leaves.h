// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/stored_array.h"
#include "renderer/core/settings/json_fwd.h"

#include <string>
#include <vector>

namespace nlos {

/// A file whose arrays and texts, or some of them, stand in JSON.
///
/// A leaf is named by its path: "configuration.range_m". Nested lists of equal lengths are one
/// array, and so are the leaves of the same key in all objects of a list, whose index is then the
/// slower axis: in {"set": [{"bin": [1, 2]}, {"bin": [3, 4]}]} "set.bin" has shape (2, 2). What
/// does not stack so is named by its index: "set.0.bin". Null is a number that is missing: NaN.
class JsonLeaves : public StoredArrayFile {
 protected:
    /// Adds all leaves of a value below `path`, which may be empty.
    void add_leaves(const std::string& path, const core::Json& value);

 private:
    /// The values at one path of all objects of a list, and of lists of lists.
    struct Stack {
        Shape shape;
        std::vector<const core::Json*> values;
    };
    void add_stack(const std::string& path, const Stack& stack);
    void add_members(const std::string& path, const Stack& stack);
    void add_numbers(const std::string& path, const Stack& stack);
    void add_by_index(const std::string& path, const Stack& stack);
};

}  // namespace nlos
