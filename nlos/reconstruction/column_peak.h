// SPDX-License-Identifier: MIT
#pragma once

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

}  // namespace nlos
