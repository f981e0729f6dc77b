// SPDX-License-Identifier: MIT
#pragma once

#include "calib/calibrate.h"
#include "renderer/core/capture/instrument_response.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace setup_test {

inline constexpr double kBin_m = 0.0096;
inline constexpr double kSigma_m = 0.012;
inline constexpr double kZero_m = 0.0371;

/// A laser and a detector in one place before a wall, steered by a galvo.
struct Device {
    double distance_m = 1.0;
    double tilt_x = 0.0;
    double tilt_y = 0.0;
    double gain = 1.0;
};

/// Commands on a grid that covers about 1 m of a wall 1 m away.
inline std::vector<std::array<double, 2>> command_grid(int n, double half) {
    std::vector<std::array<double, 2>> commands;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            commands.push_back(
                {half * (2.0 * i / (n - 1) - 1.0), half * (2.0 * j / (n - 1) - 1.0)});
        }
    }
    return commands;
}

inline core::Vec3 turned(const Device& device, const core::Vec3& d) {
    return Eigen::AngleAxisd(device.tilt_y, core::Vec3::UnitY()) *
           (Eigen::AngleAxisd(device.tilt_x, core::Vec3::UnitX()) * d);
}

inline core::Vec3 position_of(const Device& device) {
    return -device.distance_m * turned(device, core::Vec3(0.0, 0.0, -1.0));
}

inline core::Vec3 spot_of(const Device& device, const std::array<double, 2>& command) {
    const core::Vec3 beam = turned(
        device,
        core::Vec3(std::tan(device.gain * command[0]), std::tan(device.gain * command[1]), -1.0));
    const core::Vec3 from = position_of(device);
    return from - from.z() / beam.z() * beam;
}

/// Counts of direct returns: photons per point, Gaussian response, a little ambient light.
inline core::Capture direct_returns(const std::vector<double>& opl_m,
                                    double photons,
                                    double tail_m,
                                    const char* seed) {
    core::Capture capture;
    capture.time_axis = {1.0, kBin_m, 400};
    std::vector<core::Vec3> points(opl_m.size(), core::Vec3::Zero());
    capture.scan = test_support::confocal_scan(points);
    capture.transient = core::Transient(opl_m.size(), capture.time_axis.num_bins);
    capture.unit = core::TransientUnit::Counts;
    std::mt19937_64 engine(test_support::seed_of(seed));
    const auto fraction_below = [&](double delay) {
        return tail_m > 0.0 ? core::exponential_gaussian_cdf(delay, kSigma_m, tail_m)
                            : core::gaussian_cdf(delay, kSigma_m);
    };
    for (std::size_t p = 0; p < opl_m.size(); ++p) {
        for (int b = 0; b < capture.time_axis.num_bins; ++b) {
            const double mean =
                0.05 + photons * (fraction_below(capture.time_axis.bin_begin_m(b + 1) - opl_m[p]) -
                                  fraction_below(capture.time_axis.bin_begin_m(b) - opl_m[p]));
            capture.transient.histogram(p)[static_cast<std::size_t>(b)] =
                static_cast<float>(std::poisson_distribution<int>(mean)(engine));
        }
    }
    return capture;
}

inline std::vector<double> ranges_of(const Device& device,
                                     const std::vector<std::array<double, 2>>& commands) {
    std::vector<double> opl;
    for (const auto& command : commands) {
        opl.push_back(kZero_m + 2.0 * (spot_of(device, command) - position_of(device)).norm());
    }
    return opl;
}

inline calib::SetupSettings setup_of(const std::vector<std::array<double, 2>>& commands) {
    calib::SetupSettings settings;
    settings.direct_returns = "test";
    settings.commands = commands;
    return settings;
}

}  // namespace setup_test
