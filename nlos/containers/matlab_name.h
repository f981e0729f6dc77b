// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// One step of a name such as `s(2).traces{0}`; numbers count from 0.
struct MatlabStep {
    enum class Kind {
        Field,    ///< a variable, or a field of a struct
        Element,  ///< (2): an element of an array of structs
        Cell      ///< {0}: an element of a cell array
    };
    Kind kind = Kind::Field;
    std::string field;
    std::size_t index = 0;
};

/// The steps of a name, of which the first is a variable; nothing when it is no such name.
std::optional<std::vector<MatlabStep>> parse_matlab_name(const std::string& name);

}  // namespace nlos
