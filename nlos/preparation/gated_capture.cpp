// SPDX-License-Identifier: MIT
#include "nlos/preparation/gated_capture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

/// Fraction of each bin that the gate covers.
std::vector<double> fractions_of(const core::TimeAxis& axis, double begin_m, double end_m) {
    std::vector<double> fractions;
    for (int bin = 0; bin < axis.num_bins; ++bin) {
        const double begin = std::max(begin_m, axis.bin_begin_m(bin));
        const double end = std::min(end_m, axis.bin_begin_m(bin + 1.0));
        fractions.push_back(std::max(0.0, end - begin) / axis.bin_width_m);
    }
    return fractions;
}

core::Transient sum_bins(const core::Transient& transient, const std::vector<double>& fractions) {
    core::Transient sums(transient.num_pairs(), 1);
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        double sum = 0.0;
        for (std::size_t bin = 0; bin < fractions.size(); ++bin) {
            sum += fractions[bin] * static_cast<double>(transient.histogram(pair)[bin]);
        }
        sums.histogram(pair)[0] = static_cast<float>(sum);
    }
    return sums;
}

/// One bin per pair, observed where every bin that the gate covers was.
core::ObservedBins observed_of(const core::Capture& capture, const std::vector<double>& fractions) {
    if (!capture.observed) return std::nullopt;
    std::vector<core::BinRange> observed;
    for (const core::BinRange& range : *capture.observed) {
        bool is_seen = true;
        for (int bin = 0; bin < capture.time_axis.num_bins; ++bin) {
            const bool is_covered = fractions[static_cast<std::size_t>(bin)] > 0.0;
            is_seen = is_seen && (!is_covered || range.holds(bin));
        }
        observed.push_back({0, is_seen ? 1 : 0});
    }
    return observed;
}

}  // namespace

core::Capture gated_capture(const core::Capture& capture,
                            double gate_start_m,
                            double gate_width_m) {
    const core::TimeAxis& axis = capture.time_axis;
    const double end_m = gate_start_m + gate_width_m;
    const double tolerance_m = 1e-9 * axis.bin_width_m * axis.num_bins;
    const bool is_within =
        gate_start_m >= axis.opl_start_m - tolerance_m && end_m <= axis.opl_end_m() + tolerance_m;
    if (!(gate_width_m > 0.0) || !is_within) {
        throw core::Error("gate",
                          fmt::format("found {} to {} m", gate_start_m, end_m),
                          fmt::format("must be wider than 0 and lie between {} and {} m",
                                      axis.opl_start_m,
                                      axis.opl_end_m()));
    }
    std::vector<double> fractions = fractions_of(axis, gate_start_m, end_m);
    const core::ObservedBins observed = observed_of(capture, fractions);
    core::Capture gated;
    gated.scan = capture.scan;
    gated.time_axis = {gate_start_m, gate_width_m, 1};
    gated.unit = capture.unit;
    gated.counts_per_radiance = capture.counts_per_radiance;
    gated.scene_info = capture.scene_info;
    gated.notes = capture.notes;
    gated.transient = sum_bins(capture.transient, fractions);
    gated.orders = capture.orders;
    for (const core::Transient& order : capture.by_order) {
        gated.by_order.push_back(sum_bins(order, fractions));
    }
    if (capture.variance) {
        for (double& fraction : fractions) fraction *= fraction;
        gated.variance = sum_bins(*capture.variance, fractions);
    }
    if (observed) core::restrict_observed(gated, *observed);
    return gated;
}

}  // namespace nlos
