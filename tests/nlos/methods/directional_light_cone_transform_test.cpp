// SPDX-License-Identifier: MIT
#include "nlos/methods/methods.h"
#include "nlos/reconstruct.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Vec3;

core::Capture dark_capture() {
    return nlos_test::confocal_capture(nlos_test::wall_grid({32, 32}, {0.03, 0.03}),
                                       {0.7, 0.01, 200});
}

/// Adds a tilted plate, z = depth + slope . (x, y), whose light carries one cosine: (n . d) / r^4.
///
/// columns   of its points along x, 10 mm apart
void add_plate(core::Capture& capture,
               double depth_m,
               const Eigen::Vector2d& slope,
               std::array<int, 2> columns) {
    const Vec3 away = Vec3(-slope.x(), -slope.y(), 1.0).normalized();
    const core::TimeAxis& axis = capture.time_axis;
    for (int ix = columns[0]; ix <= columns[1]; ++ix) {
        for (int iy = -26; iy <= 26; ++iy) {
            const Vec3 p(0.01 * ix, 0.01 * iy, depth_m + 0.01 * (slope.x() * ix + slope.y() * iy));
            for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
                const Vec3 d = p - capture.scan.wall().sensing.positions[pair];
                const double bin = (2.0 * d.norm() - axis.opl_start_m) / axis.bin_width_m - 0.5;
                const auto first = static_cast<std::size_t>(bin);
                if (bin < 0.0 || first + 1 >= capture.transient.num_bins()) continue;
                const double value = away.dot(d) / std::pow(d.norm(), 4);
                const double late = bin - static_cast<double>(first);
                capture.transient.histogram(pair)[first] += static_cast<float>(value * (1 - late));
                capture.transient.histogram(pair)[first + 1] += static_cast<float>(value * late);
            }
        }
    }
}

/// Median angle [deg] of the normals of columns [begin, end) along x to those of a plate.
double median_angle_deg(const core::Capture& capture,
                        const Eigen::Vector2d& slope,
                        std::size_t begin,
                        std::size_t end) {
    ReconstructSettings settings;
    settings.method = Method::Dlct;
    settings.volume.z_range_m = {0.35, 1.1};
    settings.snr = 100.0;
    const Reconstruction result = reconstruct(capture, settings, {});
    const Vec3 expected = Vec3(slope.x(), slope.y(), -1.0).normalized();
    std::vector<double> angles;
    for (std::size_t ix = begin; ix < end; ++ix) {
        for (std::size_t iy = 10; iy < 22; ++iy) {
            const std::size_t i = result.depth.index(ix, iy);
            if (!result.depth.is_foreground(i)) continue;
            angles.push_back(std::acos(std::min(1.0, result.depth.normals[i].dot(expected))) *
                             180.0 / core::kPi);
        }
    }
    if (angles.size() < 8 * (end - begin)) return 180.0;
    const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
    std::nth_element(angles.begin(), middle, angles.end());
    return *middle;
}

TEST(DirectionalLightConeTransform, FindsNormalsOfTiltedPlates) {
    for (const Eigen::Vector2d& slope :
         {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.5, 0.0), Eigen::Vector2d(-0.2, 0.4)}) {
        core::Capture capture = dark_capture();
        add_plate(capture, 0.6, slope, {-26, 26});
        EXPECT_LT(median_angle_deg(capture, slope, 10, 22), 10.0) << slope.transpose();
    }
}

TEST(DirectionalLightConeTransform, FindsNormalsInFrontOfTheTypicalDepth) {
    const Eigen::Vector2d slope(0.0, 0.4);
    core::Capture capture = dark_capture();
    add_plate(capture, 0.5, slope, {-30, -8});
    add_plate(capture, 0.9, {0.0, 0.0}, {4, 34});
    EXPECT_LT(median_angle_deg(capture, slope, 8, 12), 8.0);
}

}  // namespace
}  // namespace nlos
