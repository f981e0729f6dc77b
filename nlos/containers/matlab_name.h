// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// One step of a name such as `s(2).traces{0}`; numbers count from 0.
struct MatlabStep {
    std::string field;                   ///< a variable, or a field of a struct; empty: a cell
    std::optional<std::size_t> element;  ///< (2): of an array of structs, whose field this is
    std::size_t cell = 0;                ///< {0}: of a cell array

    bool is_cell() const { return field.empty(); }
};

/// The steps of a name, of which the first is a variable; nothing when it is no such name.
std::optional<std::vector<MatlabStep>> parse_matlab_name(const std::string& name);

}  // namespace nlos
