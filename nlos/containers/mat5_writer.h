// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/shape.h"

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace nlos {

/// A real array to write, first index fastest.
struct MatVariable {
    std::string name;
    Shape shape;  ///< as MATLAB counts: first index first
    std::variant<std::vector<std::uint16_t>, std::vector<float>, std::vector<double>> values;
};

/// Writes a MATLAB v5 file, compressed; whole or not at all.
///
/// throws   core::Error for a bad target, core::Failure when writing fails
void write_mat_file(const std::string& path, const std::vector<MatVariable>& variables);

}  // namespace nlos
