// SPDX-License-Identifier: MIT
#include "tests/apps/commands/simulated_walk.h"

#include "nlos/detector/count_sampling.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/capture/sensor_model.h"
#include "renderer/core/random.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace test_support {
namespace {

using core::Vec3;

constexpr int kZonePoints = 8;
constexpr double kPlanck_J_s = 6.62607015e-34;
constexpr double kSensorDistance_m = 1.0;
constexpr double kBehind_m = 3.2;  // a surface that stands still
constexpr int kWaves = 3;

/// A smooth random way between two ends of an axis: waves of 4 to 12 s.
class Way {
 public:
    Way(double low, double high, core::Rng& rng) : middle_(0.5 * (low + high)) {
        double sum = 0.0;
        for (int i = 0; i < kWaves; ++i) {
            waves_.push_back({0.2 + rng.uniform(),
                              2.0 * core::kPi / (4.0 + 8.0 * rng.uniform()),
                              2.0 * core::kPi * rng.uniform()});
            sum += waves_.back()[0];
        }
        for (auto& wave : waves_) wave[0] *= 0.5 * (high - low) / sum;
    }

    double at(double time_s) const {
        double value = middle_;
        for (const auto& [size, rate, phase] : waves_)
            value += size * std::sin(rate * time_s + phase);
        return value;
    }

 private:
    double middle_;
    std::vector<std::array<double, 3>> waves_;
};

std::vector<Vec3> disc_points(const Vec3& center, double area_m2) {
    std::vector<Vec3> points{center};
    const double radius_m = std::sqrt(area_m2 / core::kPi);
    for (int ring = 1; ring <= 2; ++ring) {
        for (int i = 0; i < 6 * ring; ++i) {
            const double angle = 2.0 * core::kPi * i / (6 * ring);
            const double r = radius_m * ring / 2.5;
            points.push_back(center + r * Vec3(std::cos(angle), std::sin(angle), 0.0));
        }
    }
    return points;
}

/// Light of one sensor before one wall, as expected counts.
class Light {
 public:
    Light(const core::SensorModel& model, const WalkSettings& settings)
        : model_(model), settings_(settings), axis_(model.time_axis()) {
        const core::SensorDetector& d = model.detector;
        sigma_m_ = core::sigma_m_from_fwhm_ps(d.response_fwhm_ps());
        const double photon_J = kPlanck_J_s * core::kSpeedOfLight / (1e-9 * d.wavelength_nm);
        counts_per_w_ = d.efficiency * d.frame_s / photon_J;
    }

    std::size_t size() const {
        return static_cast<std::size_t>(model_.num_zones()) *
               static_cast<std::size_t>(axis_.num_bins);
    }

    /// Counts per unit of radiance over a zone, per watt of laser power.
    double scale() const {
        return model_.detector.laser_w * 1e-6 * model_.detector.aperture_mm2 *
               core::zone_etendue_sr(model_) * counts_per_w_;
    }

    void add_target(const core::SensorFootprints& f,
                    const Vec3& center,
                    std::vector<double>& counts) const {
        const std::vector<Vec3> points = disc_points(center, settings_.target_area_m2);
        const double fraction = settings_.target_area_m2 / static_cast<double>(points.size());
        for (const Vec3& x : points) {
            add_returns(f, counts, [&](const Vec3& s) {
                const Vec3 d = x - s;
                const double r = d.norm();
                const double cosine = f.normal.dot(d) / r;
                const double there = settings_.wall_albedo / core::kPi * cosine / (r * r);
                return std::pair(
                    2.0 * r,
                    there * settings_.target_albedo * fraction * settings_.wall_albedo / core::kPi);
            });
        }
    }

    void add_scene(const core::SensorFootprints& f, std::vector<double>& counts) const {
        const double direct = settings_.wall_albedo / core::kPi;
        add_returns(f, counts, [&](const Vec3&) { return std::pair(0.0, direct); });
        // Light that comes back from a wide surface behind.
        add_returns(f, counts, [&](const Vec3& s) {
            return std::pair(2.0 * (kBehind_m - 0.1 * s.x()), 3e-3 * direct);
        });
        const core::SensorDetector& d = model_.detector;
        const double dark =
            d.dark_counts_hz * d.frame_s / axis_.num_bins + settings_.ambient_counts;
        for (double& count : counts) count += dark;
    }

    void mix_zones(std::vector<double>& counts) const {
        const auto bins = static_cast<std::size_t>(axis_.num_bins);
        const std::vector<double> before = counts;
        const int columns = model_.zones[0];
        const int rows = model_.zones[1];
        const double fraction = model_.detector.zone_crosstalk;
        const auto zone = [&](int x, int y) {
            return static_cast<std::size_t>(y * columns + x) * bins;
        };
        for (int y = 0; y < rows; ++y) {
            for (int x = 0; x < columns; ++x) {
                for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
                    const int i = x + dx;
                    const int j = y + dy;
                    if (i < 0 || j < 0 || i >= columns || j >= rows) continue;
                    for (std::size_t b = 0; b < bins; ++b) {
                        counts[zone(i, j) + b] += fraction * before[zone(x, y) + b];
                        counts[zone(x, y) + b] -= fraction * before[zone(x, y) + b];
                    }
                }
            }
        }
    }

 private:
    /// back(s) says how much longer than the direct return light takes from a point of the wall,
    /// and the radiance that leaves it then for an irradiance of 1.
    template <class Back>
    void add_returns(const core::SensorFootprints& f,
                     std::vector<double>& counts,
                     const Back& back) const {
        const double unit = scale();
        for (std::size_t z = 0; z < f.zones.size(); ++z) {
            const core::PatchPoints& seen = f.zones[z].seen;
            for (std::size_t i = 0; i < seen.size(); ++i) {
                const auto [more_m, radiance] = back(seen.positions[i]);
                const double opl_m =
                    seen.device_m[i] + (seen.positions[i] - f.laser_m).norm() + more_m;
                add_pulse(opl_m,
                          unit * seen.weights[i] * f.zones[z].seen_irradiance[i] * radiance,
                          z,
                          counts);
            }
        }
    }

    void add_pulse(double opl_m,
                   double amount,
                   std::size_t zone,
                   std::vector<double>& counts) const {
        constexpr double kReach = 6.0;
        const double from = (opl_m - kReach * sigma_m_ - axis_.opl_start_m) / axis_.bin_width_m;
        const double to = (opl_m + kReach * sigma_m_ - axis_.opl_start_m) / axis_.bin_width_m;
        const int last = std::min(axis_.num_bins - 1, static_cast<int>(to));
        int bin = std::max(0, static_cast<int>(std::floor(from)));
        double below = core::gaussian_cdf(axis_.bin_begin_m(bin) - opl_m, sigma_m_);
        for (; bin <= last; ++bin) {
            const double above = core::gaussian_cdf(axis_.bin_begin_m(bin + 1) - opl_m, sigma_m_);
            counts[zone * static_cast<std::size_t>(axis_.num_bins) +
                   static_cast<std::size_t>(bin)] += amount * (above - below);
            below = above;
        }
    }

    core::SensorModel model_;
    WalkSettings settings_;
    core::TimeAxis axis_;
    double sigma_m_ = 0.0;
    double counts_per_w_ = 0.0;
};

core::SensorSetup setup_of(const core::SensorModel& model) {
    core::SensorSetup setup;
    setup.model = model;
    setup.pose.position_m = Vec3(0.0, 0.0, kSensorDistance_m);
    setup.wall.size_m = {20.0, 20.0};
    return setup;
}

}  // namespace

SimulatedWalk simulate_walk(const WalkSettings& settings) {
    const core::SensorModel model = core::read_sensor_model(settings.sensor);
    core::SensorSetup setup = setup_of(model);
    SimulatedWalk walk;
    walk.sensor.axis = model.time_axis();
    walk.sensor.wall = setup.wall;
    walk.sensor.setup = setup;
    walk.sensor.sigma_m = core::sigma_m_from_fwhm_ps(model.detector.response_fwhm_ps());
    walk.sensor.frame_s = model.detector.frame_s;
    core::SensorSetup fine = setup;
    fine.subsamples = kZonePoints;
    core::Rng rng(settings.seed, 0, 0);
    const Way x(-0.9, 0.9, rng), y(-0.4, 0.5, rng), z(0.5, 2.0, rng), slide(-0.3, 0.3, rng);
    const Light light(model, settings);
    for (int f = 0; f < settings.frames; ++f) {
        const double time_s = f * model.detector.frame_s;
        if (settings.sensor_moves) fine.pose.position_m.x() = slide.at(time_s);
        const core::SensorFootprints footprints = core::make_footprints(fine);
        std::vector<double> counts(light.size(), 0.0);
        calib::TrackedFrame truth;
        truth.time_s = time_s;
        if (settings.has_target && f >= settings.first && f < settings.last) {
            truth.targets.push_back({Vec3(x.at(time_s), y.at(time_s), z.at(time_s)), std::nullopt});
            light.add_target(footprints, truth.targets.front().position_m, counts);
        }
        double signal = 0.0;
        for (const double count : counts) signal += count;
        walk.signal_counts.push_back(signal);
        light.add_scene(footprints, counts);
        light.mix_zones(counts);
        calib::TrackFrame frame;
        frame.time_s = time_s;
        frame.pose = fine.pose;
        core::Rng noise(settings.seed, 1, static_cast<std::uint64_t>(f));
        for (const double count : counts) {
            frame.counts.push_back(static_cast<double>(nlos::sample_poisson(noise, count)));
        }
        walk.frames.push_back(std::move(frame));
        walk.truth.push_back(std::move(truth));
    }
    walk.retro_strength = light.scale() * std::pow(settings.wall_albedo / core::kPi, 2) *
                          settings.target_albedo * settings.target_area_m2;
    return walk;
}

}  // namespace test_support
