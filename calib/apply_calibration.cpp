// SPDX-License-Identifier: MIT
#include "calib/calibrate.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

// Moves every histogram by its own delay, splitting light linearly between bins.
core::Transient delayed(const core::Transient& transient,
                        const core::TimeAxis& axis,
                        const std::vector<double>& delays_m) {
    core::Transient result(transient.num_pairs(), axis.num_bins);
    core::parallel_for(transient.num_pairs(), [&](std::size_t pair) {
        const core::MeasuredResponse delay{{delays_m[pair]}, {1.0}};
        core::apply_filter<float, float>(core::sample_response(delay, axis.bin_width_m),
                                         transient.histogram(pair),
                                         result.histogram(pair));
    });
    return result;
}

// Everything beside the transient itself, which would no longer belong to it.
void drop_other_histograms(core::Capture& capture) {
    capture.variance.reset();
    capture.orders.clear();
    capture.by_order.clear();
    capture.velocity.reset();
    capture.sequence.reset();
}

// Bins of which both that light was split from were observed.
void delay_observed(const std::vector<double>& delays_m, core::Capture& capture) {
    if (!capture.observed) return;
    const core::BinRange axis{0, capture.time_axis.num_bins};
    std::vector<core::BinRange> ranges;
    for (std::size_t pair = 0; pair < delays_m.size(); ++pair) {
        const core::BinRange& range = (*capture.observed)[pair];
        const double delay = delays_m[pair] / capture.time_axis.bin_width_m;
        ranges.push_back(core::intersection({static_cast<int>(std::ceil(range.begin + delay)),
                                             static_cast<int>(std::floor(range.end + delay))},
                                            axis));
    }
    capture.observed.reset();
    core::restrict_observed(capture, ranges);
}

}  // namespace

std::vector<double> pair_offsets(const AppliedCalibration& calibration,
                                 const core::WallScan& scan) {
    std::vector<double> offsets;
    const auto& offset = calibration.opl_offset_m;
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        offsets.push_back(
            0.5 * (offset[scan.illumination_index(pair)] + offset[scan.sensing_index(pair)]));
    }
    return offsets;
}

void replace_points(const AppliedCalibration& calibration, core::WallScan& scan) {
    const auto replace = [&](core::WallPoints& points) {
        if (points.size() != calibration.points_m.size()) {
            throw core::Error("--calibration",
                              fmt::format("found {} points", calibration.points_m.size()),
                              fmt::format("the scan has {}", points.size()));
        }
        points.positions = calibration.points_m;
        points.normals = calibration.normals;
    };
    if (scan.pattern == core::ScanPattern::Single) {
        throw core::Error("--calibration",
                          "found a scan with a single laser spot",
                          "must be confocal or exhaustive over the calibrated points");
    }
    replace(scan.sensing);
    replace(scan.illumination);
    scan.opl_origin = core::OplOrigin::RelayWall;
}

core::Capture apply_calibration(const AppliedCalibration& calibration,
                                const core::Capture& capture) {
    core::Capture result = capture;
    drop_other_histograms(result);
    replace_points(calibration, result.scan.wall());
    std::vector<double> delays = pair_offsets(calibration, result.scan.wall());
    const double first = *std::min_element(delays.begin(), delays.end());
    for (double& delay : delays) delay = first - delay;
    result.time_axis.opl_start_m -= first;
    result.transient = delayed(capture.transient, capture.time_axis, delays);
    delay_observed(delays, result);
    result.notes.push_back("points and path lengths are those of a calibration");
    return result;
}

core::TimeAxis axis_to_render(const AppliedCalibration& calibration, const core::TimeAxis& axis) {
    const auto [least, most] =
        std::minmax_element(calibration.opl_offset_m.begin(), calibration.opl_offset_m.end());
    const core::InstrumentResponse response =
        core::make_response(calibration.response, "--calibration: response");
    const core::ResponseFilter filter = core::sample_response(response, axis.bin_width_m);
    const int reach = std::abs(filter.first_delay) + static_cast<int>(filter.weights.size());
    const int ahead = static_cast<int>(std::ceil(*most / axis.bin_width_m)) + reach;
    const int spread = static_cast<int>(std::ceil((*most - *least) / axis.bin_width_m));
    core::TimeAxis result = axis;
    result.opl_start_m -= ahead * axis.bin_width_m;
    result.num_bins += spread + 2 * reach;
    return result;
}

core::Capture record_with(const AppliedCalibration& calibration,
                          const core::Capture& rendered,
                          const core::TimeAxis& axis) {
    core::Capture result = rendered;
    const std::vector<double> offsets = pair_offsets(calibration, rendered.scan.wall());
    const double shift = axis.opl_start_m - rendered.time_axis.opl_start_m;
    std::vector<double> delays;
    for (const double offset : offsets) delays.push_back(offset - shift);
    const core::InstrumentResponse response =
        core::make_response(calibration.response, "--calibration: response");
    const core::Transient smeared =
        core::apply_filter(core::sample_response(response, axis.bin_width_m), rendered.transient);
    const core::Transient moved = delayed(smeared, rendered.time_axis, delays);
    drop_other_histograms(result);
    result.time_axis = axis;
    result.transient = core::Transient(rendered.transient.num_pairs(), axis.num_bins);
    for (std::size_t pair = 0; pair < moved.num_pairs(); ++pair) {
        const auto from = moved.histogram(pair);
        const auto count = std::min(from.size(), result.transient.num_bins());
        std::copy_n(from.begin(), count, result.transient.histogram(pair).begin());
    }
    return result;
}

}  // namespace calib
