// SPDX-License-Identifier: MIT
#include "renderer/wall_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::size_t kMostBoxes = 64;

}  // namespace

WallBoxes::Boxes WallBoxes::make_boxes(const core::WallPoints& points, const Vec3& origin) {
    // Runs of neighbouring indices are neighbours on the wall, or the boxes are merely larger.
    const std::size_t per_box = (points.size() + kMostBoxes - 1) / kMostBoxes;
    Boxes boxes;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % per_box == 0) boxes.emplace_back();
        boxes.back().extend(points.positions[i] - origin);
    }
    return boxes;
}

WallBoxes::WallBoxes(const core::Scan& scan, const Vec3& origin)
    : confocal_(scan.pattern == core::ScanPattern::Confocal),
      light_(make_boxes(scan.illumination, origin)),
      sensor_(make_boxes(scan.sensing, origin)) {
    device_legs_ = {std::numeric_limits<double>::infinity(), 0.0};
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        const double legs = scan.device_legs_m(pair);
        device_legs_.least_m = std::min(device_legs_.least_m, legs);
        device_legs_.most_m = std::max(device_legs_.most_m, legs);
    }
    const auto add_plane = [&](const core::WallPoints& points, std::size_t i) {
        const Vec3& normal = points.normals[i];
        const double height = normal.dot(points.positions[i] - origin);
        for (const auto& [known, known_height] : sensor_planes_) {
            if (known == normal && std::abs(known_height - height) < 1e-12 * (1.0 + std::abs(height))) {
                return;
            }
        }
        sensor_planes_.emplace_back(normal, height);
    };
    for (std::size_t i = 0; i < scan.sensing.size(); ++i) add_plane(scan.sensing, i);
    for (std::size_t i = 0; i < scan.illumination.size(); ++i) add_plane(scan.illumination, i);
    if (sensor_planes_.size() == 1) plane_ = sensor_planes_.front();
}

LengthBounds WallBoxes::legs(const Boxes& boxes, const Vec3& center, double radius) {
    LengthBounds bounds{std::numeric_limits<double>::infinity(), 0.0};
    for (const auto& box : boxes) {
        bounds.least_m = std::min(bounds.least_m, box.squaredExteriorDistance(center));
        const Vec3 farthest =
            (center - box.min()).cwiseAbs().cwiseMax((center - box.max()).cwiseAbs());
        bounds.most_m = std::max(bounds.most_m, farthest.squaredNorm());
    }
    return {std::max(0.0, std::sqrt(bounds.least_m) - radius), std::sqrt(bounds.most_m) + radius};
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
    return std::all_of(sensor_planes_.begin(), sensor_planes_.end(), [&](const auto& plane) {
        return plane.first.dot(center) - plane.second < -radius;
    });
}

}  // namespace renderer
