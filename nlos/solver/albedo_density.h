// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"

#include <cmath>

namespace nlos {

/// The solver's volumes are albedo per metre of depth, whatever operator and voxels they were found
/// with: that of a surface which faces a white wall from afar adds up along z to its albedo.
///
/// returns   that density in a voxel for every unit of light that the voxel adds to a histogram of
///           radiance, times the falloff
inline double albedo_density_of_light(const MethodInput& input) {
    const auto size_of = [&](const std::vector<double>& centers, std::size_t axis) {
        const double footprint = input.wall.max_m[axis] - input.wall.min_m[axis];
        return centers.size() > 1
                   ? (centers.back() - centers.front()) / static_cast<double>(centers.size() - 1)
                   : footprint;
    };
    const double depth =
        (input.z_range_m[1] - input.z_range_m[0]) / static_cast<double>(input.axes.z_m.size());
    const double volume = size_of(input.axes.x_m, 0) * size_of(input.axes.y_m, 1) * depth;
    return volume > 0.0 ? std::pow(core::kPi, 3) / volume : 1.0;
}

}  // namespace nlos
