// SPDX-License-Identifier: MIT
#include "apps/bench/fit/fit.h"
#include "calib/calibrate.h"
#include "nlos/detector/count_sampling.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

#include <cmath>

namespace apps {
namespace {

using core::Vec3;

constexpr double kTilt_rad = 30.0 * core::kPi / 180.0;
constexpr double kZero_m = 0.0371;
constexpr double kPhotons = 1000.0;
constexpr double kAmbient = 0.05;

// 16 x 16 beams that cover about 1 m of a wall 1 m along the middle one.
std::vector<std::array<double, 2>> beam_commands() {
    constexpr int kBeams = 16;
    constexpr double kHalf_rad = 0.46;
    std::vector<std::array<double, 2>> commands;
    for (int i = 0; i < kBeams; ++i) {
        for (int j = 0; j < kBeams; ++j) {
            commands.push_back({kHalf_rad * (2.0 * i / (kBeams - 1) - 1.0),
                                kHalf_rad * (2.0 * j / (kBeams - 1) - 1.0)});
        }
    }
    return commands;
}

// The wall is the plane through (0, 0, -1) whose normal is turned from the device's z axis.
double path_length(const std::array<double, 2>& command) {
    const Vec3 beam = Vec3(std::tan(command[0]), std::tan(command[1]), -1.0).normalized();
    const Vec3 normal(0.0, std::sin(kTilt_rad), std::cos(kTilt_rad));
    return kZero_m + 2.0 * normal.z() / -normal.dot(beam);
}

core::Capture direct_returns(std::uint64_t seed) {
    const auto commands = beam_commands();
    const double sigma_m = core::sigma_m_from_fwhm_ps(94.0);
    core::Capture capture;
    capture.time_axis = {1.0, core::opl_from_seconds(32e-12), 400};
    capture.unit = core::TransientUnit::Counts;
    capture.transient = core::Transient(commands.size(), capture.time_axis.num_bins);
    core::WallScan& scan = capture.scan.wall();
    scan.sensing.positions.assign(commands.size(), Vec3::Zero());
    scan.sensing.normals.assign(commands.size(), Vec3::UnitZ());
    scan.illumination = scan.sensing;
    for (std::size_t p = 0; p < commands.size(); ++p) {
        core::Rng rng(seed, p, 0);
        const double opl_m = path_length(commands[p]);
        const auto below = [&](int bin) {
            return core::gaussian_cdf(capture.time_axis.bin_begin_m(bin) - opl_m, sigma_m);
        };
        for (int b = 0; b < capture.time_axis.num_bins; ++b) {
            const double mean = kAmbient + kPhotons * (below(b + 1) - below(b));
            capture.transient.histogram(p)[static_cast<std::size_t>(b)] =
                static_cast<float>(nlos::sample_poisson(rng, mean));
        }
    }
    return capture;
}

}  // namespace

void bench_direct_returns(int trials, FitBench& bench) {
    calib::SetupSettings settings;
    settings.direct_returns = "simulated";
    settings.commands = beam_commands();
    double angle2 = 0.0;
    double distance2 = 0.0;
    double zero2 = 0.0;
    for (int i = 0; i < trials; ++i) {
        const calib::Calibration result =
            calib::calibrate(settings, direct_returns(static_cast<std::uint64_t>(i)));
        const auto& values = result.setup.values;
        distance2 += std::pow(values[0] - 1.0, 2.0) / trials;
        angle2 += (std::pow(std::abs(values[1]) - kTilt_rad, 2.0) + values[2] * values[2]) / trials;
        zero2 += std::pow(values[6] - kZero_m, 2.0) / trials;
    }
    const double angle_mrad = 1e3 * std::sqrt(angle2);
    const double distance_mm = 1e3 * std::sqrt(distance2);
    const double zero_ps = 1e12 * std::sqrt(zero2) / core::kSpeedOfLight;
    bench.rows.push_back(
        {"direct returns, 1 m, 30 deg, 1000 photons/point: angle / distance / time zero",
         "0.3 mrad / 0.6 mm / 4 ps",
         fmt::format("{:.2f} mrad / {:.2f} mm / {:.1f} ps", angle_mrad, distance_mm, zero_ps),
         angle_mrad < 0.3 && distance_mm < 0.6 && zero_ps < 4.0});
}

}  // namespace apps
