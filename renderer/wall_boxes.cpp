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

WallBoxes::Runs WallBoxes::make_runs(const core::WallPoints& points, const Vec3& origin) {
    // Runs of neighbouring indices are neighbours on the wall, or the boxes are merely larger.
    const std::size_t per_box = (points.size() + kMostBoxes - 1) / kMostBoxes;
    Runs runs;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % per_box == 0) runs.emplace_back();
        runs.back().points.push_back(points.positions[i] - origin);
        runs.back().box.extend(runs.back().points.back());
    }
    return runs;
}

WallBoxes::WallBoxes(const core::Scan& scan, const Vec3& origin)
    : confocal_(scan.pattern == core::ScanPattern::Confocal),
      light_(make_runs(scan.illumination, origin)),
      sensor_(make_runs(scan.sensing, origin)) {
    device_legs_ = {std::numeric_limits<double>::infinity(), 0.0};
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        const double legs = scan.device_legs_m(pair);
        device_legs_.least_m = std::min(device_legs_.least_m, legs);
        device_legs_.most_m = std::max(device_legs_.most_m, legs);
    }
    const auto add_plane = [&](const core::WallPoints& points, std::size_t i) {
        if (planes_.size() > kMostPlanes) return;
        const Vec3& normal = points.normals[i];
        const double height = normal.dot(points.positions[i] - origin);
        for (const auto& [known, known_height] : planes_) {
            if (known == normal &&
                std::abs(known_height - height) < 1e-12 * (1.0 + std::abs(height))) {
                return;
            }
        }
        planes_.emplace_back(normal, height);
    };
    for (std::size_t i = 0; i < scan.sensing.size(); ++i) add_plane(scan.sensing, i);
    for (std::size_t i = 0; i < scan.illumination.size(); ++i) add_plane(scan.illumination, i);
    if (planes_.size() == 1) plane_ = planes_.front();
}

LengthBounds WallBoxes::legs(const Runs& runs, const Vec3& center, double radius) {
    LengthBounds bounds{std::numeric_limits<double>::infinity(), 0.0};
    for (const auto& [box, points] : runs) {
        bounds.least_m = std::min(bounds.least_m, box.squaredExteriorDistance(center));
        const Vec3 farthest =
            (center - box.min()).cwiseAbs().cwiseMax((center - box.max()).cwiseAbs());
        bounds.most_m = std::max(bounds.most_m, farthest.squaredNorm());
    }
    return {std::max(0.0, std::sqrt(bounds.least_m) - radius), std::sqrt(bounds.most_m) + radius};
}

double WallBoxes::nearest(const Runs& runs, const Vec3& center, double radius) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& [box, points] : runs) {
        if (box.squaredExteriorDistance(center) >= best) continue;
        for (const Vec3& point : points) best = std::min(best, (point - center).squaredNorm());
    }
    return std::max(0.0, std::sqrt(best) - radius);
}

std::pair<double, double> WallBoxes::nearest_m(const Vec3& center, double radius) const {
    const double sensor = nearest(sensor_, center, radius);
    return {confocal_ ? sensor : nearest(light_, center, radius), sensor};
}

LengthBounds WallBoxes::light_legs(const Vec3& center, double radius) const {
    return legs(light_, center, radius);
}

LengthBounds WallBoxes::sensor_legs(const Vec3& center, double radius) const {
    return legs(sensor_, center, radius);
}

LengthBounds WallBoxes::path_lengths(const Vec3& center, double radius) const {
    const LengthBounds sensor = sensor_legs(center, radius);
    const LengthBounds light = confocal_ ? sensor : light_legs(center, radius);
    return {sensor.least_m + light.least_m + device_legs_.least_m,
            sensor.most_m + light.most_m + device_legs_.most_m};
}

bool WallBoxes::is_behind(const Vec3& center, double radius) const {
    if (planes_.size() > kMostPlanes) return false;
    return std::all_of(planes_.begin(), planes_.end(), [&](const auto& plane) {
        return plane.first.dot(center) - plane.second < -radius;
    });
}

}  // namespace renderer
