// SPDX-License-Identifier: MIT
#include "calib/track/target_response.h"

#include "renderer/core/capture/instrument_response.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using core::Vec3;

constexpr double kReachSigmas = 4.5;
constexpr double kStepsPerSigma = 32.0;
constexpr double kLitStepsPerSigma = 8.0;
constexpr double kSmallestSigmaBins = 0.25;

}  // namespace

double response_sigma_m(double pulse_sigma_m, double radius_m, double bin_width_m) {
    // A ball's points lie radius / sqrt(5) from its centre along any direction, and the path there
    // and back is twice as long.
    const double body_m = 2.0 * radius_m / std::sqrt(5.0);
    return std::max(std::hypot(pulse_sigma_m, body_m), kSmallestSigmaBins * bin_width_m);
}

PulseTable::PulseTable(double sigma_m, double width_m)
    : reach_m_(kReachSigmas * sigma_m + 0.5 * width_m), per_m_(kStepsPerSigma / sigma_m) {
    const auto steps = static_cast<std::size_t>(std::ceil(2.0 * reach_m_ * per_m_)) + 2;
    const auto density = [&](double u) {
        return std::exp(-0.5 * u * u / (sigma_m * sigma_m)) /
               (sigma_m * std::sqrt(2.0 * core::kPi));
    };
    for (std::size_t i = 0; i < steps; ++i) {
        const double u = static_cast<double>(i) / per_m_ - reach_m_;
        fraction_.push_back(core::gaussian_cdf(u + 0.5 * width_m, sigma_m) -
                            core::gaussian_cdf(u - 0.5 * width_m, sigma_m));
        slope_.push_back(density(u + 0.5 * width_m) - density(u - 0.5 * width_m));
    }
}

// The pulse of every point lit, at the distance that it has from the target, on an even axis.
struct TargetResponse::LitPulse {
    double start_m = 0.0;
    double per_m = 0.0;
    double end_m = 0.0;
    std::vector<double> fraction;
    std::vector<double> slope;
    std::vector<Vec3> gradient;
};

TargetResponse::TargetResponse(const core::SensorFootprints& footprints,
                               const core::TimeAxis& axis,
                               const TargetSettings& target,
                               core::SensorIllumination illumination,
                               core::OplOrigin opl_origin,
                               double sigma_m,
                               const ZoneCrosstalk& crosstalk)
    : axis_(axis),
      normal_(footprints.normal),
      crosstalk_(crosstalk),
      pulse_(response_sigma_m(sigma_m, target.radius_m, axis.bin_width_m), axis.bin_width_m),
      sigma_m_(response_sigma_m(sigma_m, target.radius_m, axis.bin_width_m)) {
    const double with_segments = opl_origin == core::OplOrigin::Device ? 1.0 : 0.0;
    const auto segments = [&](const core::PatchPoints& points) {
        std::vector<Segment> list;
        for (std::size_t i = 0; i < points.size(); ++i) {
            list.push_back(
                {points.positions[i], points.weights[i], with_segments * points.device_m[i]});
        }
        return list;
    };
    for (const core::ZoneFootprint& footprint : footprints.zones) {
        Zone zone;
        zone.seen = segments(footprint.seen);
        const std::vector<Segment> lit = segments(footprint.lit);
        if (target.returns_light()) {
            for (std::size_t i = 0; i < zone.seen.size(); ++i) {
                Segment point = zone.seen[i];
                point.weight *= footprint.seen_irradiance[i];
                point.device_m += with_segments * (point.position_m - footprints.laser_m).norm();
                zone.there_and_back.push_back(point);
            }
            zone.seen.clear();
        } else if (illumination == core::SensorIllumination::Zones) {
            zone.lit = lit;
        } else {
            flood_.insert(flood_.end(), lit.begin(), lit.end());
        }
        zones_.push_back(std::move(zone));
    }
}

TargetResponse::Reach TargetResponse::reach(const Segment& segment,
                                            const Vec3& position_m,
                                            double segments) const {
    const Vec3 d = position_m - segment.position_m;
    const double r = d.norm();
    const double height = normal_.dot(d);
    if (height <= 0.0) return {segment.device_m + segments * r, 0.0, Vec3::Zero(), Vec3::Zero()};
    const double per_r3 = segment.weight / (r * r * r);
    return {segment.device_m + segments * r,
            height * per_r3,
            (segments / r) * d,
            per_r3 * (normal_ - (3.0 * height / (r * r)) * d)};
}

TargetResponse::Reaches TargetResponse::reaches(const std::vector<Segment>& segments,
                                                const Vec3& position_m,
                                                double ways) const {
    Reaches result;
    result.all.reserve(segments.size());
    for (const Segment& segment : segments) {
        const Reach& one = result.all.emplace_back(reach(segment, position_m, ways));
        result.first_m = std::min(result.first_m, one.opl_m);
        result.last_m = std::max(result.last_m, one.opl_m);
    }
    return result;
}

TargetResponse::Window TargetResponse::bins_around(double first_m,
                                                   double last_m,
                                                   double margin_m) const {
    const auto bin = [&](double opl_m) {
        const double position = (opl_m - axis_.opl_start_m) / axis_.bin_width_m - 0.5;
        return std::clamp(position, -1.0, static_cast<double>(axis_.num_bins));
    };
    const int begin = std::max(0, static_cast<int>(std::ceil(bin(first_m - margin_m))));
    const int end =
        std::min(axis_.num_bins, static_cast<int>(std::floor(bin(last_m + margin_m))) + 1);
    return {begin, std::max(begin, end)};
}

TargetResponse::Window TargetResponse::add_retroreflective(const Zone& zone,
                                                           const Vec3& position_m,
                                                           std::span<double> values,
                                                           std::span<Vec3> gradient) const {
    const Reaches ways = reaches(zone.there_and_back, position_m, 2.0);
    if (ways.all.empty()) return {};
    const Window window = bins_around(ways.first_m, ways.last_m, pulse_.reach_m());
    for (int i = window.begin; i < window.end; ++i) {
        const auto bin = static_cast<std::size_t>(i);
        const double center_m = axis_.bin_center_m(i);
        double value = 0.0;
        Vec3 slope = Vec3::Zero();
        for (const Reach& r : ways.all) {
            const PulseTable::Value pulse = pulse_.at(center_m - r.opl_m);
            value += r.weight * pulse.fraction;
            slope += pulse.fraction * r.weight_gradient - (r.weight * pulse.slope) * r.opl_gradient;
        }
        values[bin] = value;
        if (!gradient.empty()) gradient[bin] = slope;
    }
    return window;
}

TargetResponse::LitPulse TargetResponse::lit_pulse(const std::vector<Segment>& lit,
                                                   const Vec3& position_m) const {
    LitPulse result;
    const Reaches ways = reaches(lit, position_m, 1.0);
    if (ways.all.empty()) return result;
    result.per_m = kLitStepsPerSigma / sigma_m_;
    result.start_m = ways.first_m - pulse_.reach_m();
    const double length_m = ways.last_m - ways.first_m + 2.0 * pulse_.reach_m();
    const auto steps = static_cast<std::size_t>(std::ceil(length_m * result.per_m)) + 2;
    result.end_m = result.start_m + static_cast<double>(steps - 1) / result.per_m;
    result.fraction.assign(steps, 0.0);
    result.slope.assign(steps, 0.0);
    result.gradient.assign(steps, Vec3::Zero());
    for (const Reach& r : ways.all) {
        const double from = (r.opl_m - pulse_.reach_m() - result.start_m) * result.per_m;
        const double to = (r.opl_m + pulse_.reach_m() - result.start_m) * result.per_m;
        const auto last = std::min(steps - 1, static_cast<std::size_t>(to));
        for (auto i = static_cast<std::size_t>(std::max(0.0, std::ceil(from))); i <= last; ++i) {
            const double at_m = result.start_m + static_cast<double>(i) / result.per_m;
            const PulseTable::Value pulse = pulse_.at(at_m - r.opl_m);
            result.fraction[i] += r.weight * pulse.fraction;
            result.slope[i] += r.weight * pulse.slope;
            result.gradient[i] +=
                pulse.fraction * r.weight_gradient - (r.weight * pulse.slope) * r.opl_gradient;
        }
    }
    return result;
}

TargetResponse::Window TargetResponse::add_diffuse(const Zone& zone,
                                                   const LitPulse& lit,
                                                   const Vec3& position_m,
                                                   std::span<double> values,
                                                   std::span<Vec3> gradient) const {
    if (lit.fraction.empty() || zone.seen.empty()) return {};
    const Reaches ways = reaches(zone.seen, position_m, 1.0);
    const Window window = bins_around(lit.start_m + ways.first_m, lit.end_m + ways.last_m, 0.0);
    for (int i = window.begin; i < window.end; ++i) {
        double value = 0.0;
        Vec3 slope = Vec3::Zero();
        for (const Reach& r : ways.all) {
            const double position = (axis_.bin_center_m(i) - r.opl_m - lit.start_m) * lit.per_m;
            if (!(position >= 0.0) || position >= static_cast<double>(lit.fraction.size() - 1))
                continue;
            const auto j = static_cast<std::size_t>(position);
            const double f = position - static_cast<double>(j);
            const auto between = [&](const auto& a, const auto& b) {
                return (1.0 - f) * a + f * b;
            };
            const double fraction = between(lit.fraction[j], lit.fraction[j + 1]);
            value += r.weight * fraction;
            if (gradient.empty()) continue;
            slope += fraction * r.weight_gradient +
                     r.weight * between(lit.gradient[j], lit.gradient[j + 1]) -
                     (r.weight * between(lit.slope[j], lit.slope[j + 1])) * r.opl_gradient;
        }
        values[static_cast<std::size_t>(i)] = value;
        if (!gradient.empty()) gradient[static_cast<std::size_t>(i)] = slope;
    }
    return window;
}

std::vector<TargetResponse::Window> TargetResponse::evaluate(const Vec3& position_m,
                                                             std::span<double> values,
                                                             std::span<Vec3> gradient) const {
    std::vector<Window> windows;
    windows.reserve(zones_.size());
    const bool flooded = !flood_.empty();
    LitPulse lit;
    if (flooded) lit = lit_pulse(flood_, position_m);
    for (std::size_t z = 0; z < zones_.size(); ++z) {
        const auto part = values.subspan(z * num_bins(), num_bins());
        const auto slope =
            gradient.empty() ? gradient : gradient.subspan(z * num_bins(), num_bins());
        if (!zones_[z].there_and_back.empty()) {
            windows.push_back(add_retroreflective(zones_[z], position_m, part, slope));
        } else {
            if (!flooded) lit = lit_pulse(zones_[z].lit, position_m);
            windows.push_back(add_diffuse(zones_[z], lit, position_m, part, slope));
        }
    }
    if (crosstalk_.fraction > 0.0) mix_zones(windows, values, gradient);
    return windows;
}

// All zones then have values in the bins that any had.
void TargetResponse::mix_zones(std::vector<Window>& windows,
                               std::span<double> values,
                               std::span<Vec3> gradient) const {
    Window all{axis_.num_bins, 0};
    for (const Window& window : windows) {
        if (window.begin >= window.end) continue;
        all = {std::min(all.begin, window.begin), std::max(all.end, window.end)};
    }
    if (all.begin >= all.end) return;
    const auto size = static_cast<std::size_t>(all.end - all.begin);
    const auto mix = [&](auto kind, auto stored) {
        using Value = decltype(kind);
        std::vector<Value> before(zones_.size() * size, kind);
        for (std::size_t z = 0; z < zones_.size(); ++z) {
            for (int b = windows[z].begin; b < windows[z].end; ++b) {
                before[z * size + static_cast<std::size_t>(b - all.begin)] =
                    stored[z * num_bins() + static_cast<std::size_t>(b)];
            }
        }
        for (int row = 0; row < crosstalk_.rows; ++row) {
            for (int column = 0; column < crosstalk_.columns; ++column) {
                const auto zone_at = [&](int c, int r) {
                    return static_cast<std::size_t>(r * crosstalk_.columns + c);
                };
                const std::size_t zone = zone_at(column, row);
                for (std::size_t b = 0; b < size; ++b) {
                    const Value& own = before[zone * size + b];
                    Value sum = own;
                    const auto exchange = [&](int c, int r) {
                        if (c < 0 || r < 0 || c >= crosstalk_.columns || r >= crosstalk_.rows)
                            return;
                        sum += crosstalk_.fraction * (before[zone_at(c, r) * size + b] - own);
                    };
                    exchange(column - 1, row);
                    exchange(column + 1, row);
                    exchange(column, row - 1);
                    exchange(column, row + 1);
                    stored[zone * num_bins() + static_cast<std::size_t>(all.begin) + b] = sum;
                }
            }
        }
    };
    mix(0.0, values);
    if (!gradient.empty()) mix(Vec3(Vec3::Zero()), gradient);
    std::fill(windows.begin(), windows.end(), all);
}

}  // namespace calib
