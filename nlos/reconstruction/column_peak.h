// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/depth_map.h"

#include <algorithm>
#include <cstddef>
#include <span>

namespace nlos {

/// Where a column of voxels is brightest, between voxels.
struct ColumnPeak {
    std::size_t voxel = 0;   ///< the highest one
    double position = 0.0;   ///< of the vertex [voxels]
    double curvature = 0.0;  ///< of the logarithm, turned positive [1 / voxels^2]
};

/// The peak that a voxel belongs to: uphill from it, at most 3 voxels away.
///
/// Its position is the vertex of a parabola through the logarithms of the highest three values,
/// right for a Gaussian of any width where a parabola through the values themselves leans towards
/// the highest voxel by up to a tenth; through the values where one is not positive. Peaks narrower
/// than a voxel, which sparse solutions have, are no samples of anything smooth: light between two
/// voxels is split among them. They are smoothed by (1, 2, 1) first, which puts the vertex within
/// 0.04 voxels of their centre of mass.
ColumnPeak find_peak(std::span<const float> column, std::size_t voxel);

/// Calls visit(jx, jy) for the foreground columns at most `reach` columns from (ix, iy) along x and
/// along y, itself included.
template <class Visit>
void visit_near(const core::DepthMap& depth,
                std::size_t ix,
                std::size_t iy,
                std::size_t reach,
                const Visit& visit) {
    const std::size_t end_x = std::min(depth.x_m.size(), ix + reach + 1);
    const std::size_t end_y = std::min(depth.y_m.size(), iy + reach + 1);
    for (std::size_t jx = ix - std::min(ix, reach); jx < end_x; ++jx) {
        for (std::size_t jy = iy - std::min(iy, reach); jy < end_y; ++jy) {
            if (depth.is_foreground(depth.index(jx, jy))) visit(jx, jy);
        }
    }
}

}  // namespace nlos
