// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruct.h"

#include <cmath>
#include <limits>

namespace test_support {

/// A small result, every value different: 3 x 2 columns of 4 voxels on a turned and shifted wall.
inline nlos::Reconstruction example_reconstruction() {
    nlos::Reconstruction result;
    nlos::VolumeAxes& axes = result.volume.axes;
    axes.x_m = {-0.1, 0.0, 0.1};
    axes.y_m = {0.3, 0.4};
    axes.z_m = {0.5, 0.6, 0.7, 0.8};
    axes.world_from_wall = Eigen::Translation3d(1.0, 2.0, 3.0) *
                           Eigen::AngleAxisd(0.3, core::Vec3(1.0, 2.0, 3.0).normalized());
    for (std::size_t i = 0; i < axes.num_voxels(); ++i) {
        result.volume.values.push_back(static_cast<float>(i % 7) + 0.25F);
    }
    result.volume.normals.assign(6, Eigen::Vector3f(0.0F, 0.6F, -0.8F));
    result.depth = core::DepthMap(axes.x_m, axes.y_m);
    result.depth.world_from_wall = axes.world_from_wall;
    result.depth.depth_m[2] = 0.6125;
    result.depth_sigma_m.assign(6, std::numeric_limits<double>::quiet_NaN());
    result.depth_sigma_m[2] = 0.0015;
    result.surface_probability = {0.0, 0.1, 0.9, 0.2, 0.3, 0.4};
    result.points.positions = {result.depth.point_world(1, 0)};
    result.points.normals = {core::Vec3(0.0, 0.0, -1.0)};
    result.method = "lct";
    result.reason = "the scan is a planar confocal grid";
    result.settings.method = nlos::Method::Lct;
    result.settings.volume.voxels = {3, 2, 4};
    result.settings.snr = 0.2;
    result.resolution_m = 0.012;
    result.seconds = 1.5;
    result.peak_bytes = 123456789;
    return result;
}

}  // namespace test_support
