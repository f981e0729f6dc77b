// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruct.h"
#include "nlos/reconstruction/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace nlos_test {

/// An even grid of wall points around the pose's origin, in the pose's x-y plane.
inline core::WallPoints wall_grid(std::array<std::size_t, 2> size,
                                  std::array<double, 2> pitch_m,
                                  const core::Transform& pose = core::Transform::Identity()) {
    core::WallPoints points;
    points.grid = size;
    for (std::size_t ix = 0; ix < size[0]; ++ix) {
        for (std::size_t iy = 0; iy < size[1]; ++iy) {
            const double x = (static_cast<double>(ix) - 0.5 * static_cast<double>(size[0] - 1));
            const double y = (static_cast<double>(iy) - 0.5 * static_cast<double>(size[1] - 1));
            points.positions.push_back(pose * core::Vec3(x * pitch_m[0], y * pitch_m[1], 0.0));
            points.normals.push_back(pose.linear().col(2));
        }
    }
    return points;
}

inline core::Capture confocal_capture(const core::WallPoints& points, const core::TimeAxis& axis) {
    core::Capture capture;
    capture.scan.wall().pattern = core::ScanPattern::Confocal;
    capture.scan.wall().sensing = points;
    capture.scan.wall().illumination = points;
    capture.time_axis = axis;
    capture.transient = core::Transient(points.size(), axis.num_bins);
    return capture;
}

/// Adds a point scatterer: 1 / r^falloff at its path length, shared by the two nearest bin centres.
inline void add_scatterer(core::Capture& capture, const core::Vec3& position, double falloff) {
    const core::TimeAxis& axis = capture.time_axis;
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        const core::WallScan& scan = capture.scan.wall();
        const double out =
            (scan.illumination.positions[scan.illumination_index(pair)] - position).norm();
        const double back = (scan.sensing.positions[scan.sensing_index(pair)] - position).norm();
        const double opl = out + back + scan.device_segments_m(pair);
        const double bin = (opl - axis.opl_start_m) / axis.bin_width_m - 0.5;
        const double first = std::floor(bin);
        if (first < 0.0 || first + 1.0 >= axis.num_bins) continue;
        const double value = std::pow(out * back, -0.5 * falloff);
        auto histogram = capture.transient.histogram(pair);
        const auto i = static_cast<std::size_t>(first);
        histogram[i] += static_cast<float>(value * (1.0 - (bin - first)));
        histogram[i + 1] += static_cast<float>(value * (bin - first));
    }
}

/// The surface point of the brightest column.
inline core::Vec3 brightest_point(const nlos::Volume& volume) {
    const core::DepthMap depth = nlos::find_surface(volume, nullptr, {}, 0.5).depth;
    const std::vector<float> projection = nlos::max_projection(volume);
    const auto column = static_cast<std::size_t>(
        std::max_element(projection.begin(), projection.end()) - projection.begin());
    const std::size_t ny = volume.axes.y_m.size();
    return depth.point_world(column / ny, column % ny);
}
inline core::Vec3 brightest_point(const nlos::Reconstruction& result) {
    return brightest_point(result.volume);
}

}  // namespace nlos_test
