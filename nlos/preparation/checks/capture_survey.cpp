// SPDX-License-Identifier: MIT
#include "nlos/preparation/checks/capture_check.h"
#include "renderer/core/capture/recorded_detector.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

std::string light_text(const PreparedCapture& prepared) {
    const auto values = prepared.transient().values();
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    const float largest = values.empty() ? 0.0F : *std::ranges::max_element(values);
    if (prepared.unit == core::TransientUnit::Radiance) {
        return fmt::format("radiance, at most {:.3g} in a bin", largest);
    }
    return fmt::format("{:.0f} counts, at most {:.0f} in a bin", sum, largest);
}

/// Light of all pairs up to each bin, background taken off; empty: none at all.
std::vector<double> light_until_bins(const PreparedCapture& prepared, const PreparationPlan& plan) {
    std::vector<double> light = light_per_bin(prepared.transient(),
                                              prepared.observed ? &*prepared.observed : nullptr,
                                              plan.ambient_per_bin);
    std::partial_sum(light.begin(), light.end(), light.begin());
    if (!(*std::ranges::max_element(light) > 0.0)) light.clear();
    return light;
}

/// The ranges at which the capture holds all but a thousandth of its light.
std::array<double, 2> light_range_m(const PreparedCapture& prepared,
                                    const std::vector<double>& light) {
    const core::TimeAxis& axis = prepared.time_axis;
    const double all = *std::ranges::max_element(light);
    const auto bin_at = [&](double fraction) {
        const auto found =
            std::ranges::find_if(light, [&](double sum) { return sum >= fraction * all; });
        return static_cast<double>(found - light.begin());
    };
    const auto [shortest_segment, longest_segment] = core::device_segment_range_m(prepared.scan);
    return {std::max(0.0, 0.5 * (axis.bin_begin_m(bin_at(0.0005)) - longest_segment)),
            std::max(0.0, 0.5 * (axis.bin_begin_m(bin_at(0.9995) + 1.0) - shortest_segment))};
}

std::string range_text(const PreparedCapture& prepared, const PreparationPlan& plan) {
    const std::vector<double> light = light_until_bins(prepared, plan);
    if (light.empty()) return "no light";
    const auto [begin, end] = light_range_m(prepared, light);
    return fmt::format("light from {:.3g} to {:.3g} m of range", begin, end);
}

std::string observed_text(const PreparedCapture& prepared) {
    const std::size_t pairs = prepared.scan.num_pairs();
    const int num_bins = prepared.time_axis.num_bins;
    if (!prepared.observed) return fmt::format("all {} bins of {} pairs observed", num_bins, pairs);
    const auto seen = std::ranges::count_if(
        *prepared.observed, [](const core::BinRange& range) { return range.size() > 0; });
    const core::BinRange hull = core::observed_hull(prepared.observed, num_bins);
    return fmt::format("{} of {} pairs observed, in bins {} to {} of {}",
                       seen,
                       pairs,
                       hull.begin,
                       hull.end - 1,
                       num_bins);
}

}  // namespace

std::vector<std::string> survey_capture(const PreparedCapture& prepared,
                                        const PreparationPlan& plan,
                                        const ReconstructSettings& settings) {
    std::vector<std::string> lines{
        light_text(prepared), range_text(prepared, plan), observed_text(prepared)};
    if (!plan.ambient_per_bin.empty()) {
        const double sum =
            std::accumulate(plan.ambient_per_bin.begin(), plan.ambient_per_bin.end(), 0.0);
        lines.push_back(fmt::format("background of {:.3g} in a bin",
                                    sum / static_cast<double>(plan.ambient_per_bin.size())));
    }
    if (core::is_given(settings.response)) lines.push_back(core::describe(settings.response));
    if (const double spot_m = settings.solver.spot_m.value_or(0.0); spot_m > 0.0) {
        lines.push_back(core::describe_spot(spot_m));
    }
    return lines;
}

std::optional<std::string> volume_warning(const PreparedCapture& prepared,
                                          const PreparationPlan& plan,
                                          const std::array<double, 2>& z_range_m) {
    constexpr double kLeastFraction = 0.01;
    const std::vector<double> light = light_until_bins(prepared, plan);
    if (light.empty()) return std::nullopt;
    const WallFrame& wall = prepared.wall;
    const double farthest_m =
        std::hypot(z_range_m[1], wall.max_m[0] - wall.min_m[0], wall.max_m[1] - wall.min_m[1]);
    const auto [shortest_segment, longest_segment] = core::device_segment_range_m(prepared.scan);
    const auto light_before = [&](double length_m) {
        const core::TimeAxis& axis = prepared.time_axis;
        const double bin = std::floor((length_m - axis.opl_start_m) / axis.bin_width_m);
        if (bin < 1.0) return 0.0;
        return light[static_cast<std::size_t>(std::min(bin, 1.0 * axis.num_bins)) - 1];
    };
    const double own =
        light_before(2.0 * farthest_m + longest_segment + prepared.time_axis.bin_width_m) -
        light_before(2.0 * z_range_m[0] + shortest_segment);
    if (own >= kLeastFraction * *std::ranges::max_element(light)) return std::nullopt;
    const auto [begin, end] = light_range_m(prepared, light);
    return fmt::format(
        "no light comes from the volume, {:.4g} to {:.4g} m before the wall: all of it lies at "
        "{:.3g} to {:.3g} m of range; --set volume.z_range_m=[{:.3g},{:.3g}]",
        z_range_m[0],
        z_range_m[1],
        begin,
        end,
        begin,
        end);
}

}  // namespace nlos
