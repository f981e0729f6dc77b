// SPDX-License-Identifier: MIT
#include "renderer/core/capture/wall_scan.h"

#include <fmt/core.h>

#include <algorithm>

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

}  // namespace

std::vector<std::size_t> WallPoints::extents() const {
    if (!grid) return {size()};
    return {grid->begin(), grid->end()};
}

std::vector<std::size_t> WallScan::pair_extents() const {
    std::vector<std::size_t> extents;
    if (is_exhaustive()) extents = illumination.extents();
    const std::vector<std::size_t> sensed = sensing.extents();
    extents.insert(extents.end(), sensed.begin(), sensed.end());
    return extents;
}

std::vector<Vec3> WallScan::path_ends() const {
    std::vector<Vec3> points = sensing.positions;
    points.insert(points.end(), illumination.positions.begin(), illumination.positions.end());
    return points;
}

std::array<double, 2> device_segment_range_m(const WallScan& scan) {
    std::array<double, 2> range{scan.device_segments_m(0), scan.device_segments_m(0)};
    for (std::size_t pair = 1; pair < scan.num_pairs(); ++pair) {
        const double segment = scan.device_segments_m(pair);
        range = {std::min(range[0], segment), std::max(range[1], segment)};
    }
    return range;
}

ScanExtent scan_extent(const WallScan& scan) {
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

void validate(const WallScan& scan, const std::string& where) {
    validate_points(scan.sensing, where + ": sensing points");
    validate_points(scan.illumination, where + ": illumination points");
    require(
        !scan.is_confocal() || scan.illumination.size() == scan.sensing.size(),
        where + ": illumination points",
        fmt::format("{}", scan.illumination.size()),
        fmt::format("as many as the {} sensing points of a confocal scan", scan.sensing.size()));
}

}  // namespace core
