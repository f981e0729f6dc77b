// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

namespace renderer {

/// The visible part of a triangle: one bit for each of the 16 congruent triangles that halving its
/// edges twice gives. Bits 4c to 4c+3 belong to quarter c; quarter 3 is the middle one, and so is
/// bit 3 within a quarter, whose centre is therefore the quarter's.
using VisibilityMask = std::uint16_t;

inline constexpr VisibilityMask kAllVisible = 0xffff;

/// Barycentric coordinates of the centre of each bit's triangle.
const std::array<std::array<double, 3>, 16>& centers_of_bits();

/// The linear function with the integral and the first moments of the visible part's indicator,
/// flattened so that it is nowhere negative: its values at the three corners.
std::array<double, 3> visible_fraction(VisibilityMask mask);

}  // namespace renderer
