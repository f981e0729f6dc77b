// SPDX-License-Identifier: MIT
#include "renderer/wall_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::size_t kMostBoxes = 64;

// Walls with more distinct tangent planes are not searched for what lies behind all of them.
constexpr std::size_t kMostPlanes = 256;

}  // namespace

WallBoxes::WallBoxes(const core::Scan& scan, const Vec3& origin)
    : confocal_(scan.pattern == core::ScanPattern::Confocal),
      sensor_(make_boxes(scan.sensing, origin)) {
    if (!confocal_) light_ = make_boxes(scan.illumination, origin);
    for (const Boxes* boxes : {&light_, &sensor_}) {
        for (const Box& box : *boxes) {
            slack_m_ = std::max(slack_m_, box.bounds.diagonal().norm());
        }
    }
    const auto [least, most] = core::device_leg_range_m(scan);
    device_legs_ = {least, most};
    find_planes(scan.sensing, origin);
    if (!confocal_) find_planes(scan.illumination, origin);
    if (planes_.size() == 1) plane_ = planes_.front();
}

void WallBoxes::find_planes(const core::WallPoints& points, const Vec3& origin) {
    for (std::size_t i = 0; i < points.size() && planes_.size() <= kMostPlanes; ++i) {
        const Vec3& normal = points.normals[i];
        const double height = normal.dot(points.positions[i] - origin);
        const bool is_known = std::any_of(planes_.begin(), planes_.end(), [&](const auto& plane) {
            return plane.first == normal &&
                   std::abs(plane.second - height) < 1e-12 * (1.0 + std::abs(height));
        });
        if (!is_known) planes_.emplace_back(normal, height);
    }
}

// Median splits along the longest side, until boxes hold few points.
void WallBoxes::split(std::vector<Vec3> points, std::size_t most_per_box, Boxes& boxes) {
    Box box;
    for (const Vec3& point : points) box.bounds.extend(point);
    if (points.size() <= most_per_box) {
        box.points = std::move(points);
        boxes.push_back(std::move(box));
        return;
    }
    Eigen::Index axis = 0;
    box.bounds.sizes().maxCoeff(&axis);
    const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
    std::nth_element(points.begin(), middle, points.end(), [axis](const Vec3& a, const Vec3& b) {
        return a[axis] < b[axis];
    });
    split({points.begin(), middle}, most_per_box, boxes);
    split({middle, points.end()}, most_per_box, boxes);
}

WallBoxes::Boxes WallBoxes::make_boxes(const core::WallPoints& points, const Vec3& origin) {
    std::vector<Vec3> positions;
    for (const Vec3& position : points.positions) positions.push_back(position - origin);
    Boxes boxes;
    split(std::move(positions), (points.size() + kMostBoxes - 1) / kMostBoxes, boxes);
    return boxes;
}

LengthBounds WallBoxes::bounds(const Boxes& boxes, const Vec3& center, double radius) {
    double least = std::numeric_limits<double>::infinity();
    double most = 0.0;
    for (const Box& box : boxes) {
        least = std::min(least, box.bounds.squaredExteriorDistance(center));
        const Vec3 farthest =
            (center - box.bounds.min()).cwiseAbs().cwiseMax((center - box.bounds.max()).cwiseAbs());
        most = std::max(most, farthest.squaredNorm());
    }
    return {std::max(0.0, std::sqrt(least) - radius), std::sqrt(most) + radius};
}

LegBounds WallBoxes::legs(const Vec3& center, double radius) const {
    const LengthBounds sensor = bounds(sensor_, center, radius);
    return {confocal_ ? sensor : bounds(light_, center, radius), sensor};
}

double WallBoxes::nearest(const Boxes& boxes, const Vec3& center, double radius) {
    double best = std::numeric_limits<double>::infinity();
    for (const Box& box : boxes) {
        if (box.bounds.squaredExteriorDistance(center) >= best) continue;
        for (const Vec3& point : box.points) best = std::min(best, (point - center).squaredNorm());
    }
    return std::max(0.0, std::sqrt(best) - radius);
}

std::pair<double, double> WallBoxes::nearest_light_and_sensor_m(const Vec3& center,
                                                                double radius) const {
    const double sensor = nearest(sensor_, center, radius);
    return {confocal_ ? sensor : nearest(light_, center, radius), sensor};
}

bool WallBoxes::is_behind(const Vec3& center, double radius) const {
    if (planes_.size() > kMostPlanes) return false;
    return std::all_of(planes_.begin(), planes_.end(), [&](const auto& plane) {
        return plane.first.dot(center) - plane.second < -radius;
    });
}

}  // namespace renderer
