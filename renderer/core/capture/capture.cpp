// SPDX-License-Identifier: MIT
#include "renderer/core/capture/capture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace core {
namespace {

void validate_histograms(const Capture& capture,
                         const Transient& transient,
                         int num_bins,
                         const std::string& where) {
    require(transient.num_pairs() == capture.scan.num_pairs() &&
                transient.num_bins() == static_cast<std::size_t>(num_bins),
            where,
            fmt::format("{} pairs x {} bins", transient.num_pairs(), transient.num_bins()),
            fmt::format("{} x {}", capture.scan.num_pairs(), num_bins));
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        const auto histogram = transient.histogram(pair);
        int strange = 0;  // counted, not searched for: the loop runs over all of the data
        for (const float value : histogram) strange += static_cast<int>(!std::isfinite(value));
        if (strange == 0) continue;
        const float value =
            *std::ranges::find_if_not(histogram, [](float x) { return std::isfinite(x); });
        throw Error(where, fmt::format("found {}", value), "must be finite numbers");
    }
}

void validate_sequence(const Capture& capture, const std::string& where) {
    const FrameSequence& sequence = *capture.sequence;
    require(!sequence.frames.empty(), where + ": frames", "none", "one and more");
    check_range(sequence.frame_s, {.low = 0.0, .with_low = true}, where + ": frame_s");
    check_range(sequence.gate_step_m, {}, where + ": gate_step_m");
    require(sequence.errors.empty() || sequence.errors.size() == sequence.frames.size(),
            where + ": errors of frames",
            fmt::format("{} values", sequence.errors.size()),
            fmt::format("one for each of {} frames", sequence.frames.size()));
    for (const double error : sequence.errors) {
        require(std::isnan(error) || (error >= 0.0 && std::isfinite(error)),
                where + ": errors of frames",
                fmt::format("{}", error),
                "0 or more, or NaN");
    }
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
        validate_histograms(capture,
                            sequence.frames[i],
                            capture.time_axis.num_bins,
                            fmt::format("{}: frame {}", where, i));
    }
}

/// Throws unless there is one range per pair, each within the axis.
void validate_ranges(const Capture& capture,
                     const std::vector<BinRange>& ranges,
                     const std::string& where) {
    require(ranges.size() == capture.scan.num_pairs(),
            where,
            fmt::format("{} ranges", ranges.size()),
            fmt::format("one for each of {} pairs", capture.scan.num_pairs()));
    const int num_bins = capture.time_axis.num_bins;
    for (std::size_t pair = 0; pair < ranges.size(); ++pair) {
        const auto [begin, end] = ranges[pair];
        if (begin >= 0 && begin <= end && end <= num_bins) continue;
        throw Error(where,
                    fmt::format("pair {} has bins {} to {}", pair, begin, end),
                    fmt::format("must begin at 0 or later, not end before that, and end at {} at "
                                "the latest",
                                num_bins));
    }
}

/// Visits the values of a pair outside its range.
template <class Values, class Visit>
void for_each_unobserved(const Values& histogram,
                         const BinRange& range,
                         int num_axes,
                         Visit&& visit) {
    const std::size_t num_bins = histogram.size() / static_cast<std::size_t>(num_axes);
    for (std::size_t i = 0; i < histogram.size(); ++i) {
        if (!range.holds(static_cast<int>(i % num_bins))) visit(histogram[i]);
    }
}

/// Throws unless histograms hold 0 where nothing was observed.
///
/// where   prefix of messages, with the histograms' name
void validate_dark(const ObservedBins& observed,
                   const Transient& transient,
                   int num_axes,
                   const std::string& where) {
    if (!observed) return;
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        const BinRange& range = (*observed)[pair];
        for_each_unobserved(transient.histogram(pair), range, num_axes, [&](float value) {
            if (value == 0.0F) return;
            throw Error(where,
                        fmt::format("pair {} holds {} beside its observed bins {} to {}",
                                    pair,
                                    value,
                                    range.begin,
                                    range.end),
                        "must hold 0 where nothing was observed");
        });
    }
}

void validate_observed(const Capture& capture, const std::string& where) {
    const std::string bins = where + ": observed bins";
    const std::size_t num_frames = capture.sequence ? capture.sequence->frames.size() : 0;
    const std::size_t num_own = capture.sequence ? capture.sequence->observed.size() : 0;
    if (!capture.observed && num_own == 0) return;
    if (!capture.scan.has_observed_bins()) {
        throw Error(bins, "found for an image", "must be of a scan's pairs");
    }
    require(num_own == 0 || num_own == num_frames,
            bins,
            fmt::format("those of {} frames", num_own),
            fmt::format("those of each of {} frames", num_frames));
    if (capture.observed) validate_ranges(capture, *capture.observed, bins);
    for (std::size_t frame = 0; frame < num_own; ++frame) {
        const ObservedBins& observed = capture.observed_in_frame(frame);
        if (observed)
            validate_ranges(capture, *observed, fmt::format("{} of frame {}", bins, frame));
    }
    std::size_t frame = 0;
    for_each_transient(capture, [&](const char* name, const Transient& transient, int num_axes) {
        const bool is_frame = std::string_view(name) == "frames";
        validate_dark(is_frame ? capture.observed_in_frame(frame++) : capture.observed,
                      transient,
                      num_axes,
                      fmt::format("{}: {}", where, name));
    });
}

}  // namespace

void validate(const Capture& capture, const std::string& where) {
    validate(capture.time_axis, where + ": time axis");
    validate(capture.scan, where);
    const int num_bins = capture.time_axis.num_bins;
    validate_histograms(capture, capture.transient, num_bins, where + ": H");
    if (capture.velocity) {
        const VelocityAxis& axis = capture.velocity->axis;
        validate(axis, where + ": velocity axis");
        validate_histograms(
            capture, capture.velocity->values, axis.num_values(num_bins), where + ": velocity");
    }
    for (const Transient& order : capture.by_order) {
        validate_histograms(capture, order, num_bins, where + ": H_by_order");
    }
    if (capture.sequence) validate_sequence(capture, where);
    validate_observed(capture, where);
}

void restrict_observed(Capture& capture, const BinRange& range) {
    restrict_observed(capture, std::vector<BinRange>(capture.scan.num_pairs(), range));
}

void restrict_observed(Capture& capture, const std::vector<BinRange>& ranges) {
    validate_ranges(capture, ranges, "observed bins");
    for_each_transient(capture, [&](const char*, Transient& transient, int num_axes) {
        for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
            for_each_unobserved(
                transient.histogram(pair), ranges[pair], num_axes, [](float& value) {
                    value = 0.0F;
                });
        }
    });
    if (!capture.scan.has_observed_bins()) return;
    const int num_bins = capture.time_axis.num_bins;
    const auto restrict_ranges = [&](ObservedBins& observed) {
        std::vector<BinRange> kept;
        for (std::size_t pair = 0; pair < ranges.size(); ++pair) {
            kept.push_back(intersection(ranges[pair], observed_range(observed, pair, num_bins)));
        }
        observed = std::move(kept);
        simplify(observed, num_bins);
    };
    restrict_ranges(capture.observed);
    if (!capture.sequence) return;
    for (ObservedBins& observed : capture.sequence->observed) restrict_ranges(observed);
}

}  // namespace core
