// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

#include <string>
#include <type_traits>
#include <vector>

namespace apps {

/// The arrays of a page: little-endian numbers, compressed with zlib, as base64 text in script
/// elements that a browser does not run. The page's data refer to them by number.
class PageArrays {
 public:
    /// returns   {"array": number, "type": "u8", "u16" or "u32", "count": of elements}
    template <class Code>
    core::Json add(const std::vector<Code>& codes) {
        static_assert(std::is_unsigned_v<Code> && sizeof(Code) <= 4);
        bytes_.emplace_back(reinterpret_cast<const char*>(codes.data()),
                            codes.size() * sizeof(Code));
        return {{"array", bytes_.size() - 1},
                {"type", "u" + std::to_string(8 * sizeof(Code))},
                {"count", codes.size()}};
    }

    /// One script element per array, id `nlos-array-NUMBER`.
    std::string html() const;

 private:
    std::vector<std::string> bytes_;
};

}  // namespace apps
