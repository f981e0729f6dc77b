// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <array>
#include <span>
#include <vector>

namespace renderer {

/// Corners of a convex polygon, counterclockwise.
using ConvexPolygon = std::vector<core::Vec2>;

double area_of(const ConvexPolygon& polygon);

/// False when polygons overlap by more than `slack`; touching ones are apart.
bool are_apart(std::span<const core::Vec2> a, std::span<const core::Vec2> b, double slack);

/// What lies in both triangles; may be empty, or a line.
ConvexPolygon intersection(const std::array<core::Vec2, 3>& a, const std::array<core::Vec2, 3>& b);

/// What of a polygon lies in none of several triangles, as polygons that do not overlap.
///
/// slack   what is nearer to an edge counts as on it; strips narrower than that are left out
std::vector<ConvexPolygon> subtract(const ConvexPolygon& polygon,
                                    std::span<const std::array<core::Vec2, 3>> triangles,
                                    double slack);

}  // namespace renderer
