// SPDX-License-Identifier: MIT
#include "renderer/core/capture.h"

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
    for (const float value : transient.values()) {
        if (!std::isfinite(value)) {
            throw Error(where, fmt::format("found {}", value), "must be finite numbers");
        }
    }
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

void validate(const Capture& capture, const std::string& where) {
    validate(capture.time_axis, where + ": time axis");
    if (capture.scan.camera) {
        validate(*capture.scan.camera, where + ": camera");
    } else {
        validate_points(capture.scan.sensing, where + ": sensing points");
        validate_points(capture.scan.illumination, where + ": illumination points");
    }
    require(capture.scan.pattern != ScanPattern::Confocal ||
                capture.scan.illumination.size() == capture.scan.sensing.size(),
            where + ": illumination points",
            fmt::format("{}", capture.scan.illumination.size()),
            fmt::format("as many as the {} sensing points of a confocal scan",
                        capture.scan.sensing.size()));
    const int num_bins = capture.time_axis.num_bins;
    validate_histograms(capture, capture.transient, num_bins, where + ": H");
    if (capture.velocity) {
        const VelocityAxis& axis = capture.velocity->axis;
        validate(axis, where + ": velocity axis");
        validate_histograms(
            capture, capture.velocity->values, axis.num_values(num_bins), where + ": velocity");
    }
    if (!capture.sequence) return;
    for (std::size_t i = 0; i < capture.sequence->frames.size(); ++i) {
        validate_histograms(
            capture, capture.sequence->frames[i], num_bins, fmt::format("{}: frame {}", where, i));
    }
}

}  // namespace core
