// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <cstddef>
#include <span>
#include <vector>

namespace nlos {

/// Voxel centres in the wall's frame: x and y along the wall, z along its normal [m].
struct VolumeAxes {
    std::vector<double> x_m;
    std::vector<double> y_m;
    std::vector<double> z_m;
    core::Transform world_from_wall = core::Transform::Identity();

    std::size_t num_voxels() const { return x_m.size() * y_m.size() * z_m.size(); }

    /// Distance of voxels along z; 0 for a single one.
    double z_step_m() const {
        return z_m.size() > 1 ? (z_m.back() - z_m.front()) / static_cast<double>(z_m.size() - 1)
                              : 0.0;
    }
};

/// A reconstructed scalar field, stored [x][y][z], z fastest.
struct Volume {
    VolumeAxes axes;
    std::vector<float> values;
    std::vector<Eigen::Vector3f> normals;  ///< per column [x][y], wall's frame; empty when unknown

    std::size_t index(std::size_t ix, std::size_t iy, std::size_t iz) const {
        return (ix * axes.y_m.size() + iy) * axes.z_m.size() + iz;
    }
};

/// The largest value of a column, which must not be empty: several are compared at a time.
float brightest_value(std::span<const float> column);

/// The brightest value along z of every column, stored [x][y].
std::vector<float> max_projection(const Volume& volume);

/// Centres of `count` cells that divide [begin, end] evenly.
std::vector<double> cell_centers(double begin, double end, std::size_t count);

}  // namespace nlos
