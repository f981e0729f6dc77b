// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_histograms.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {

using core::Capture;
using core::Error;

core::TimeAxis read_axis(const LayoutFiles& files,
                         const LayoutBins& bins,
                         std::size_t count,
                         const CaptureReadSettings& settings) {
    core::TimeAxis axis;
    axis.num_bins = static_cast<int>(count);
    if (settings.bin_width_m) {
        axis.bin_width_m = *settings.bin_width_m;
    } else if (const auto width_m = files.number(bins.width_m, "capture.bin_width_m")) {
        axis.bin_width_m = *width_m;
    } else {
        axis.bin_width_m =
            core::opl_from_seconds(*files.number(bins.width_s, "capture.bin_width_m"));
    }
    axis.opl_start_m = 0.0;
    if (const auto start_m = files.number(bins.start_m, "capture.opl_shift_m")) {
        axis.opl_start_m = *start_m;
    } else if (const auto start_s = files.number(bins.start_s, "capture.opl_shift_m")) {
        axis.opl_start_m = core::opl_from_seconds(*start_s);
    } else if (const auto start = files.number(bins.start_bins, "capture.opl_shift_m")) {
        axis.opl_start_m = *start * axis.bin_width_m;
    } else if (const auto centre_m = files.number(bins.centre_m, "capture.opl_shift_m")) {
        axis.opl_start_m = *centre_m - 0.5 * axis.bin_width_m;
    }
    core::validate(axis, files.path() + ": time axis");
    return axis;
}

std::vector<int> read_delays(const LayoutFiles& files,
                             const LayoutShift& shift,
                             const HistogramArray& histograms,
                             const PairNumbers& numbers) {
    Layout delays;
    delays.histogram.array = {shift.array};
    delays.histogram.axes = shift.axes;
    const auto array = find_histograms(files, delays);
    const auto fits = [&](const std::string& axis) {
        return array->extent(axis) == histograms.extent(axis);
    };
    if (!array || !std::all_of(shift.axes.begin(), shift.axes.end(), fits)) {
        throw Error(files.where(shift.array),
                    "has shape " + shape_text(files.shape(shift.array)),
                    "must have one value for each histogram");
    }
    const std::vector<double> values = files.read(shift.array);
    const bool x_first = shift.axes.front().back() == 'x';
    const std::size_t rows = array->extents[x_first ? 1 : 0];
    const std::size_t columns = array->extents[x_first ? 0 : 1];
    const bool first_fastest = files.first_index_fastest(shift.array);
    std::vector<int> bins(numbers.sensing.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double delay = std::floor(values[i] * shift.bins_per_unit);
        if (!(std::abs(delay) < 1e9)) {
            throw Error(files.where(shift.array),
                        fmt::format("value {} is {}", i, values[i]),
                        "must be finite delays");
        }
        // Storage runs along the first or the last axis; entries have x before y.
        const bool x_fastest = x_first == first_fastest;
        const std::size_t x = x_fastest ? i % columns : i / rows;
        const std::size_t y = x_fastest ? i / columns : i % rows;
        bins[numbers.sensing[x * rows + y]] = static_cast<int>(delay);
    }
    return bins;
}

void take_off_delays(const std::vector<int>& delays, Capture& capture) {
    std::vector<core::BinRange> observed;
    const int bins = capture.time_axis.num_bins;
    for (std::size_t pair = 0; pair < delays.size(); ++pair) {
        const int delay = std::clamp(delays[pair], -bins, bins);
        core::for_each_transient(capture, [&](const char*, core::Transient& transient, int) {
            const auto histogram = transient.histogram(pair);
            if (delay > 0) {
                std::shift_left(histogram.begin(), histogram.end(), delay);
            } else {
                std::shift_right(histogram.begin(), histogram.end(), -delay);
            }
        });
        observed.push_back({std::max(0, -delay), bins - std::max(0, delay)});
    }
    core::restrict_observed(capture, observed);
}

core::BinRange lit_bins(const Capture& capture) {
    core::BinRange lit{capture.time_axis.num_bins, 0};
    core::for_each_transient(capture, [&](const char*, const core::Transient& transient, int) {
        for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
            const auto histogram = transient.histogram(pair);
            const auto is_lit = [](float value) { return value != 0.0F; };
            const auto first = std::find_if(histogram.begin(), histogram.end(), is_lit);
            if (first == histogram.end()) continue;
            const auto last = std::find_if(histogram.rbegin(), histogram.rend(), is_lit);
            lit.begin = std::min(lit.begin, static_cast<int>(first - histogram.begin()));
            lit.end = std::max(lit.end, static_cast<int>(histogram.rend() - last));
        }
    });
    return lit.begin < lit.end ? lit : core::BinRange{0, capture.time_axis.num_bins};
}

}  // namespace nlos
