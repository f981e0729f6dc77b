// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/shape.h"

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace nlos {

/// A real array to write, first index fastest, or a struct of shape (1, 1).
struct MatVariable {
    std::string name;
    Shape shape;  ///< as MATLAB counts: first index first
    std::variant<std::vector<std::uint16_t>,
                 std::vector<float>,
                 std::vector<double>,
                 std::vector<MatVariable>>  ///< the fields of a struct
        values;
};

/// Writes a MATLAB v5 file, compressed; whole or not at all.
///
/// throws   core::Error for a bad target or a variable of 2 GiB or more, which the format cannot
///          hold; core::Failure when writing fails
void write_mat_file(const std::string& path, const std::vector<MatVariable>& variables);

}  // namespace nlos
