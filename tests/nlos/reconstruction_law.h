// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruct.h"
#include "tests/nlos/every_method.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace nlos_test {

inline constexpr std::size_t kColumns = 16;
inline constexpr double kPitch_m = 0.04;
inline const core::TimeAxis kAxis{0.0, 0.016, 144};

/// A method on a kind of scan.
struct LawCase {
    MethodCase method;
    core::ScanPattern pattern;
    bool is_non_negative;
    bool is_linear;  ///< where the volume is not cut off at 0

    int num_positions() const { return method.iterates() ? 3 : 5; }  ///< tried
    bool is_wave() const { return method.traits->propagates_wave; }
};

/// What laws ask of a method: a capture with points in it, a reconstruction, tolerances.
class ReconstructionLaw : public testing::TestWithParam<LawCase> {
 protected:
    static core::Capture dark_capture(const core::Transform& pose = core::Transform::Identity(),
                                      const core::TimeAxis& axis = kAxis,
                                      std::size_t columns = kColumns) {
        core::Capture capture =
            confocal_capture(wall_grid({columns, columns}, {kPitch_m, kPitch_m}, pose), axis);
        capture.scan.wall().pattern = GetParam().pattern;
        if (GetParam().pattern == core::ScanPattern::Single) {
            capture.scan.wall().illumination = wall_grid({1, 1}, {1.0, 1.0}, pose);
        }
        if (GetParam().pattern == core::ScanPattern::Exhaustive) {
            capture.scan.wall().illumination = wall_grid({2, 1}, {0.4, 0.4}, pose);
        }
        capture.transient = core::Transient(capture.scan.num_pairs(), axis.num_bins);
        return capture;
    }

    /// As many columns as wall points.
    static nlos::Reconstruction run(const core::Capture& capture,
                                    int num_z = 75,
                                    const std::array<double, 2>& z_range_m = {0.3, 0.9}) {
        const auto columns = static_cast<int>(std::sqrt(capture.scan.wall().sensing.size()));
        nlos::ReconstructSettings settings = GetParam().method.settings();
        settings.volume = {std::array{columns, columns, num_z}, z_range_m};
        return nlos::reconstruct(capture, settings, {});
    }

    /// The nearest column; one of the two that a point lies between where expectation maximisation
    /// gathers all light in one.
    static double lateral_tolerance_m() {
        const bool gathers =
            GetParam().method.iterates() && GetParam().pattern != core::ScanPattern::Confocal;
        return (gathers ? 1.0 : 0.5) * kPitch_m;
    }

    /// A tenth of a bin in path length, half as much in depth. Methods that iterate gather a point
    /// in one bin of squared range, of which there are as many as bins: anywhere in such a bin is
    /// the same to them.
    static double depth_tolerance_m(const core::Vec3& scatterer,
                                    const core::TimeAxis& axis = kAxis) {
        const double bin_m2 = std::pow(0.5 * axis.opl_end_m(), 2) / axis.num_bins;
        const double half_bin_m = bin_m2 / (4.0 * scatterer.z());  // dz = dv / (2 z)
        return 0.05 * axis.bin_width_m + (GetParam().method.iterates() ? half_bin_m : 0.0);
    }

    /// A random place straight before a wall point, some columns away from the wall's edges.
    static core::Vec3 random_position(std::mt19937_64& generator) {
        std::uniform_int_distribution<int> column(5, kColumns - 6);
        std::uniform_real_distribution<double> depth(0.4, 0.75);
        const auto coordinate = [&] {
            return (column(generator) - 0.5 * (kColumns - 1)) * kPitch_m;
        };
        const double x = coordinate();
        const double y = coordinate();
        return {x, y, depth(generator)};
    }

    /// Smallest and largest depth at which paths as long as those to `scatterer` meet its column.
    static std::array<double, 2> depths_of_light(const core::WallScan& scan,
                                                 const core::Vec3& scatterer,
                                                 const core::Vec3& column) {
        std::array<double, 2> range{1e300, 0.0};
        for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
            const core::Vec3& l = scan.illumination.positions[scan.illumination_index(pair)];
            const core::Vec3& s = scan.sensing.positions[scan.sensing_index(pair)];
            const auto length = [&](const core::Vec3& p) {
                return (l - p).norm() + (p - s).norm();
            };
            core::Vec3 p = column;
            for (int step = 0; step < 5; ++step) {  // of Newton's method
                const double slope = (p - l).normalized().z() + (p - s).normalized().z();
                p.z() -= (length(p) - length(scatterer)) / slope;
            }
            range = {std::min(range[0], p.z()), std::max(range[1], p.z())};
        }
        return range;
    }

    static void expect_finite(const nlos::Reconstruction& result, const char* what) {
        for (const float value : result.volume.values) {
            ASSERT_TRUE(std::isfinite(value)) << what;
            if (GetParam().is_non_negative) {
                ASSERT_GE(value, 0.0F) << what;
            }
        }
    }
};

}  // namespace nlos_test
