// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace nlos {

/// Extents of an array, slowest first; empty for a scalar.
using Shape = std::vector<std::size_t>;

/// Text of a shape for messages: (64, 64, 3).
std::string shape_text(const Shape& shape);

/// Number of values times `bytes` each; the largest number when that does not fit 64 bits.
std::uint64_t total_bytes(const Shape& shape, std::uint64_t bytes);

/// Number of values at each index of the slowest axis; 1 for a scalar.
std::uint64_t values_per_row(const Shape& shape);

}  // namespace nlos
