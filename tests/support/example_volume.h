// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruct.h"

#include <limits>
#include <vector>

namespace test_support {

inline constexpr double kBackground = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kVoxelDepth_m = 0.70;  ///< of the voxels that column_volume() fills

/// A volume of one row of columns along x, 0.1 m apart, each with one bright voxel of three.
///
/// brightness   of each column's middle voxel, which lies at kVoxelDepth_m
/// depth_m      per column, kBackground allowed; empty: no depth anywhere
inline nlos::Reconstruction column_volume(const std::vector<float>& brightness,
                                          const std::vector<double>& depth_m) {
    nlos::Reconstruction result;
    nlos::VolumeAxes& axes = result.volume.axes;
    for (std::size_t i = 0; i < brightness.size(); ++i) {
        axes.x_m.push_back(0.1 * static_cast<double>(i));
    }
    axes.y_m = {0.0};
    axes.z_m = {kVoxelDepth_m - 0.05, kVoxelDepth_m, kVoxelDepth_m + 0.05};
    for (const float value : brightness) {
        result.volume.values.insert(result.volume.values.end(), {0.0F, value, 0.0F});
    }
    result.depth = core::DepthMap(axes.x_m, axes.y_m);
    if (!depth_m.empty()) result.depth.depth_m = depth_m;
    for (std::size_t i = 0; i < brightness.size(); ++i) {
        if (result.depth.is_foreground(i)) {
            result.points.positions.push_back(result.depth.point_world(i, 0));
        }
    }
    result.method = "bp";
    return result;
}

/// A truth on the columns of a volume, in the same wall's frame.
inline core::DepthMap truth_of(const nlos::Reconstruction& result,
                               const std::vector<double>& depth_m) {
    core::DepthMap truth(result.volume.axes.x_m, result.volume.axes.y_m);
    truth.depth_m = depth_m;
    truth.world_from_wall = result.volume.axes.world_from_wall;
    return truth;
}

}  // namespace test_support
