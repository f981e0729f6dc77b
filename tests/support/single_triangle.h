// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/triangle/triangle_histogram.h"

namespace test_support {

/// Adds the exact histogram of one triangle without bend, see renderer::add_triangles().
inline void add_triangle(const renderer::TriangleKnots& knots,
                         double area_m2,
                         const core::TimeAxis& axis,
                         std::span<double> histogram) {
    renderer::TriangleLanes lanes;
    lanes.area_m2[0] = area_m2;
    for (std::size_t j = 0; j < 3; ++j) {
        lanes.opl_m[j][0] = knots.opl_m[j];
        lanes.bend_m[j][0] = 0.0;
        lanes.weight[j][0] = knots.weight[j];
    }
    renderer::add_triangles(lanes, 1, axis, histogram);
}

}  // namespace test_support
