// SPDX-License-Identifier: MIT
#include "renderer/core/capture/capture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace core {
namespace {

void validate_points(const WallPoints& points, const std::string& where) {
    if (points.size() == 0) throw Error(where, "found no point", "must have at least one");
    require(points.normals.size() == points.size(),
            where + " normals",
            fmt::format("{} for {} points", points.normals.size(), points.size()),
            "one per point");
    if (points.grid && (*points.grid)[0] * (*points.grid)[1] != points.size()) {
        throw Error(where + " grid",
                    fmt::format("found {} x {}", (*points.grid)[0], (*points.grid)[1]),
                    fmt::format("must multiply to {} points", points.size()));
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points.positions[i].allFinite() || !points.normals[i].allFinite()) {
            throw Error(where, fmt::format("point {} is not finite", i), "must be finite numbers");
        }
        if (points.normals[i].norm() < 1e-6) {
            throw Error(where + " normals",
                        fmt::format("normal {} has length 0", i),
                        "must be unit vectors");
        }
    }
}

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

void validate_observed(const Capture& capture, const std::string& where) {
    if (!capture.observed) return;
    if (capture.scan.camera) {
        throw Error(where + ": observed bins", "found for an image", "must be of a scan's pairs");
    }
    validate_ranges(capture, *capture.observed, where + ": observed bins");
    for_each_transient(capture, [&](const char* name, const Transient& transient, int num_axes) {
        for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
            const BinRange& range = (*capture.observed)[pair];
            for_each_unobserved(transient.histogram(pair), range, num_axes, [&](float value) {
                if (value == 0.0F) return;
                throw Error(fmt::format("{}: {}", where, name),
                            fmt::format("pair {} holds {} beside its observed bins {} to {}",
                                        pair,
                                        value,
                                        range.begin,
                                        range.end),
                            "must hold 0 where nothing was observed");
            });
        }
    });
}

}  // namespace

std::array<double, 2> device_leg_range_m(const Scan& scan) {
    std::array<double, 2> range{scan.device_legs_m(0), scan.device_legs_m(0)};
    for (std::size_t pair = 1; pair < scan.num_pairs(); ++pair) {
        const double leg = scan.device_legs_m(pair);
        range = {std::min(range[0], leg), std::max(range[1], leg)};
    }
    return range;
}

ScanExtent scan_extent(const Scan& scan) {
    const WallPoints& points = scan.scanned_points();
    const Vec3& first = points.positions.front();
    ScanExtent extent;
    if (points.grid) {
        const auto [nx, ny] = *points.grid;
        const Vec3 along_x = points.positions[(nx - 1) * ny] - first;
        const Vec3 along_y = points.positions[ny - 1] - first;
        if (along_x.norm() > 0.0) extent.axes[0] = along_x.normalized();
        if (along_y.norm() > 0.0) extent.axes[1] = along_y.normalized();
    }
    for (int i = 0; i < 2; ++i) {
        double low = extent.axes[i].dot(first);
        double high = low;
        for (const Vec3& position : points.positions) {
            low = std::min(low, extent.axes[i].dot(position));
            high = std::max(high, extent.axes[i].dot(position));
        }
        extent.middle_m[i] = 0.5 * (low + high);
        extent.size_m[i] = high - low;
    }
    return extent;
}

void validate(const Scan& scan, const std::string& where) {
    if (scan.camera) {
        validate(*scan.camera, where + ": camera");
    } else {
        validate_points(scan.sensing, where + ": sensing points");
        validate_points(scan.illumination, where + ": illumination points");
    }
    require(
        scan.pattern != ScanPattern::Confocal || scan.illumination.size() == scan.sensing.size(),
        where + ": illumination points",
        fmt::format("{}", scan.illumination.size()),
        fmt::format("as many as the {} sensing points of a confocal scan", scan.sensing.size()));
}

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
    for (std::size_t i = 0; capture.sequence && i < capture.sequence->frames.size(); ++i) {
        validate_histograms(
            capture, capture.sequence->frames[i], num_bins, fmt::format("{}: frame {}", where, i));
    }
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
    if (capture.scan.camera) return;
    std::vector<BinRange> kept;
    for (std::size_t pair = 0; pair < ranges.size(); ++pair) {
        kept.push_back(intersection(ranges[pair], capture.observed_range(pair)));
    }
    capture.observed = std::move(kept);
    simplify(capture.observed, capture.time_axis.num_bins);
}

}  // namespace core
