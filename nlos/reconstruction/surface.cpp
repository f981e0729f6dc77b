// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>

namespace nlos {
namespace {

using core::Vec3;

/// Position of the maximum in voxels: vertex of the parabola through the logarithms of the highest
/// three values, right for a Gaussian of any width where a parabola through the values themselves
/// leans towards the highest voxel by up to a tenth; through the values where one is not positive.
double peak_position(const float* values, std::size_t count, std::size_t highest) {
    const auto center = static_cast<double>(highest);
    if (highest == 0 || highest + 1 == count) return center;
    std::array<double, 3> three{values[highest - 1], values[highest], values[highest + 1]};
    if (three[0] > 0.0 && three[2] > 0.0) {
        for (double& value : three) value = std::log(value);
    }
    const double curvature = three[0] - 2.0 * three[1] + three[2];
    if (!(curvature < 0.0)) return center;
    return center + std::clamp(0.5 * (three[0] - three[2]) / curvature, -0.5, 0.5);
}

/// Depth at a position between evenly spaced voxel centres.
double depth_at(const std::vector<double>& z_m, double position) {
    if (z_m.size() == 1) return z_m.front();
    const double step = (z_m.back() - z_m.front()) / static_cast<double>(z_m.size() - 1);
    return z_m.front() + position * step;
}

/// Normal in the wall's frame, towards the wall, of the plane z = a x + b y + c through the
/// foreground columns around (ix, iy) that continue its surface.
Vec3 fitted_normal(const core::DepthMap& depth, std::size_t ix, std::size_t iy) {
    constexpr std::size_t kReach = 2;
    constexpr double kSteepest = 4.0;  // a larger slope is another surface
    const double z = depth.depth_m[depth.index(ix, iy)];
    core::Mat3 lhs = 1e-9 * core::Mat3::Identity();
    Vec3 rhs = Vec3::Zero();
    double scale = 0.0;
    const std::size_t end_x = std::min(depth.x_m.size(), ix + kReach + 1);
    const std::size_t end_y = std::min(depth.y_m.size(), iy + kReach + 1);
    for (std::size_t jx = ix - std::min(ix, kReach); jx < end_x; ++jx) {
        for (std::size_t jy = iy - std::min(iy, kReach); jy < end_y; ++jy) {
            const std::size_t j = depth.index(jx, jy);
            if (!depth.is_foreground(j)) continue;
            const double dx = depth.x_m[jx] - depth.x_m[ix];
            const double dy = depth.y_m[jy] - depth.y_m[iy];
            const double dz = depth.depth_m[j] - z;
            const double distance = std::hypot(dx, dy);
            if (std::abs(dz) > kSteepest * distance) continue;
            if (scale == 0.0) scale = distance;
            const Vec3 row(dx / std::max(scale, 1e-12), dy / std::max(scale, 1e-12), 1.0);
            lhs += row * row.transpose();
            rhs += row * dz;
        }
    }
    if (scale == 0.0) return -Vec3::UnitZ();
    const Vec3 plane = lhs.ldlt().solve(rhs) / scale;
    return Vec3(plane.x(), plane.y(), -1.0).normalized();
}

}  // namespace

core::DepthMap extract_depth_map(const Volume& volume, double mask_threshold) {
    const VolumeAxes& axes = volume.axes;
    core::DepthMap depth(axes.x_m, axes.y_m);
    depth.world_from_wall = axes.world_from_wall;
    depth.normals.assign(depth.depth_m.size(), Vec3::Zero());
    if (volume.values.empty()) return depth;
    const float maximum = *std::max_element(volume.values.begin(), volume.values.end());
    const double threshold = mask_threshold * static_cast<double>(maximum);
    if (!(maximum > 0.0F)) return depth;

    const std::size_t nz = axes.z_m.size();
    for (std::size_t column = 0; column < depth.depth_m.size(); ++column) {
        const float* values = volume.values.data() + column * nz;
        const auto highest =
            static_cast<std::size_t>(std::max_element(values, values + nz) - values);
        if (static_cast<double>(values[highest]) < threshold) continue;
        depth.depth_m[column] = depth_at(axes.z_m, peak_position(values, nz, highest));
    }
    for (std::size_t ix = 0; ix < axes.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < axes.y_m.size(); ++iy) {
            const std::size_t i = depth.index(ix, iy);
            if (!depth.is_foreground(i)) continue;
            depth.normals[i] = axes.world_from_wall.linear() * fitted_normal(depth, ix, iy);
        }
    }
    return depth;
}

}  // namespace nlos
