// SPDX-License-Identifier: MIT
#include "nlos/preparation/capture_check.h"
#include "renderer/core/capture/recorded_detector.h"

#include <fmt/format.h>

#include <algorithm>
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

/// The ranges at which the capture holds all but a thousandth of its light, background taken off.
std::string range_text(const PreparedCapture& prepared, const PreparationPlan& plan) {
    const core::TimeAxis& axis = prepared.time_axis;
    std::vector<double> light = light_per_bin(prepared.transient(),
                                              prepared.observed ? &*prepared.observed : nullptr,
                                              plan.ambient_per_bin);
    std::partial_sum(light.begin(), light.end(), light.begin());
    const double all = *std::ranges::max_element(light);
    if (!(all > 0.0)) return "no light";
    const auto bin_at = [&](double share) {
        const auto found =
            std::ranges::find_if(light, [&](double sum) { return sum >= share * all; });
        return static_cast<double>(found - light.begin());
    };
    const auto [shortest_leg, longest_leg] = core::device_leg_range_m(prepared.scan);
    return fmt::format(
        "light from {:.3g} to {:.3g} m of range",
        std::max(0.0, 0.5 * (axis.bin_begin_m(bin_at(0.0005)) - longest_leg)),
        std::max(0.0, 0.5 * (axis.bin_begin_m(bin_at(0.9995) + 1.0) - shortest_leg)));
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
    if (core::is_stated(settings.response)) lines.push_back(core::describe(settings.response));
    if (const double spot_m = settings.solver.spot_m.value_or(0.0); spot_m > 0.0) {
        lines.push_back(core::describe_spot(spot_m));
    }
    return lines;
}

}  // namespace nlos
