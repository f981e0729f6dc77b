// SPDX-License-Identifier: MIT
#include "renderer/geometry/wall_boxes.h"

#include "renderer/geometry/median_split.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::size_t kMaxBoxes = 64;

// Walls with more distinct tangent planes are not searched for what lies behind all of them.
constexpr std::size_t kMaxPlanes = 256;

using Runs = std::vector<std::span<Vec3>>;

// Median splits along the longest side, until runs hold few points.
void split(std::span<Vec3> points, std::size_t max_per_run, Runs& runs) {
    if (points.size() <= max_per_run) {
        runs.push_back(points);
        return;
    }
    Eigen::AlignedBox3d box;
    for (const Vec3& point : points) box.extend(point);
    const std::size_t half = points.size() / 2;
    split_along_longest_side(points, half, box, [](const Vec3& p) -> const Vec3& { return p; });
    split(points.first(half), max_per_run, runs);
    split(points.subspan(half), max_per_run, runs);
}

// Values per box, vectorized and without heap allocation.
using PerBox = Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxBoxes, 1>;

// Squared distances from a point to the nearest of each box, given by two corners.
PerBox squared_distances(const Eigen::ArrayX3d& lower,
                         const Eigen::ArrayX3d& upper,
                         const Vec3& point) {
    PerBox sum = PerBox::Zero(lower.rows());
    for (Eigen::Index c = 0; c < 3; ++c) {
        sum += (lower.col(c) - point[c]).max(point[c] - upper.col(c)).max(0.0).square();
    }
    return sum;
}

}  // namespace

WallBoxes::WallBoxes(const core::WallScan& scan, const Vec3& origin, double rounding_m)
    : confocal_(scan.pattern == core::ScanPattern::Confocal),
      sensor_(make_boxes(scan.sensing, origin)) {
    if (!confocal_) light_ = make_boxes(scan.illumination, origin);
    for (const Boxes* boxes : {&light_, &sensor_}) {
        for (Eigen::Index i = 0; i < boxes->lower.rows(); ++i) {
            const double diagonal = (boxes->upper.row(i) - boxes->lower.row(i)).matrix().norm();
            slack_m_ = std::max(slack_m_, diagonal);
        }
    }
    const auto [least, most] = core::device_segment_range_m(scan);
    device_segments_ = {least, most};
    find_planes(scan.sensing, origin, rounding_m);
    if (!confocal_) find_planes(scan.illumination, origin, rounding_m);
    if (planes_.size() == 1) plane_ = planes_.front();
}

void WallBoxes::find_planes(const core::WallPoints& points, const Vec3& origin, double rounding_m) {
    constexpr double kRoundings = 4.0;
    for (std::size_t i = 0; i < points.size() && planes_.size() <= kMaxPlanes; ++i) {
        const Vec3& normal = points.normals[i];
        const double height = normal.dot(points.positions[i] - origin);
        const double apart = std::max(1e-12 * (1.0 + std::abs(height)), kRoundings * rounding_m);
        const bool is_known = std::any_of(planes_.begin(), planes_.end(), [&](const auto& plane) {
            return plane.first == normal && std::abs(plane.second - height) < apart;
        });
        if (!is_known) planes_.emplace_back(normal, height);
    }
}

WallBoxes::Boxes WallBoxes::make_boxes(const core::WallPoints& points, const Vec3& origin) {
    std::vector<Vec3> positions;
    for (const Vec3& position : points.positions) positions.push_back(position - origin);
    Runs runs;
    // Halved six times, runs are as short as that.
    split(positions, (points.size() + kMaxBoxes - 1) / kMaxBoxes, runs);
    Boxes boxes;
    boxes.points.resize(static_cast<Eigen::Index>(positions.size()), 3);
    boxes.lower.resize(static_cast<Eigen::Index>(runs.size()), 3);
    boxes.upper.resize(boxes.lower.rows(), 3);
    Eigen::Index row = 0;
    for (const std::span<Vec3> run : runs) {
        const auto box = static_cast<Eigen::Index>(boxes.first_point.size());
        boxes.first_point.push_back(row);
        Eigen::AlignedBox3d bounds;
        for (const Vec3& point : run) {
            bounds.extend(point);
            boxes.points.row(row++) = point;
        }
        boxes.lower.row(box) = bounds.min();
        boxes.upper.row(box) = bounds.max();
    }
    boxes.first_point.push_back(row);
    return boxes;
}

LengthBounds WallBoxes::bounds(const Boxes& boxes, const Vec3& center, double radius) {
    const double least = squared_distances(boxes.lower, boxes.upper, center).minCoeff();
    PerBox farthest = PerBox::Zero(boxes.lower.rows());
    for (Eigen::Index c = 0; c < 3; ++c) {
        farthest += (boxes.upper.col(c) - center[c]).max(center[c] - boxes.lower.col(c)).square();
    }
    return {std::max(0.0, std::sqrt(least) - radius), std::sqrt(farthest.maxCoeff()) + radius};
}

SegmentBounds WallBoxes::segments(const Vec3& center, double radius) const {
    const LengthBounds sensor = bounds(sensor_, center, radius);
    return {confocal_ ? sensor : bounds(light_, center, radius), sensor};
}

double WallBoxes::nearest(const Boxes& boxes, const Vec3& center, double radius) {
    const PerBox distances2 = squared_distances(boxes.lower, boxes.upper, center);
    double best = std::numeric_limits<double>::infinity();
    const auto look_into = [&](Eigen::Index box) {
        const Eigen::Index begin = boxes.first_point[static_cast<std::size_t>(box)];
        const Eigen::Index end = boxes.first_point[static_cast<std::size_t>(box) + 1];
        const auto offset2 = [&](Eigen::Index c) {
            return (boxes.points.col(c).segment(begin, end - begin) - center[c]).square();
        };
        best = std::min(best, (offset2(0) + offset2(1) + offset2(2)).minCoeff());
    };
    Eigen::Index first = 0;
    distances2.minCoeff(&first);
    look_into(first);
    for (Eigen::Index box = 0; box < distances2.size(); ++box) {
        if (distances2[box] < best && box != first) look_into(box);
    }
    return std::max(0.0, std::sqrt(best) - radius);
}

std::pair<double, double> WallBoxes::nearest_light_and_sensor_m(const Vec3& center,
                                                                double radius) const {
    const double sensor = nearest(sensor_, center, radius);
    return {confocal_ ? sensor : nearest(light_, center, radius), sensor};
}

bool WallBoxes::is_behind(const Vec3& center, double radius) const {
    if (planes_.size() > kMaxPlanes) return false;
    return std::all_of(planes_.begin(), planes_.end(), [&](const auto& plane) {
        return plane.first.dot(center) - plane.second < -radius;
    });
}

}  // namespace renderer
