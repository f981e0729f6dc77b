// SPDX-License-Identifier: MIT
#include "calib/forward/wall_motion.h"

#include <algorithm>
#include <cmath>

namespace calib {

using core::Vec3;

WallMotion::WallMotion(const core::WallScan& scan) {
    const core::WallPoints& points = scan.sensing;
    for (std::size_t i = 0; i < points.size(); ++i) {
        center_ += points.positions[i] / static_cast<double>(points.size());
        normal_ += points.normals[i];
    }
    normal_.normalize();
    for (const Vec3& p : points.positions) {
        squared_radius_m2_ = std::max(squared_radius_m2_, (p - center_).squaredNorm());
    }
    if (squared_radius_m2_ == 0.0) squared_radius_m2_ = 1.0;  // a single point cannot bow
}

std::vector<MovedWallPoint> WallMotion::moved(const core::WallPoints& points,
                                              const SceneState& state) const {
    const double scale = std::exp(state.log_wall_scale);
    std::vector<MovedWallPoint> result;
    result.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 p = points.positions[i] - center_;
        const double rise = 1.0 - p.squaredNorm() / squared_radius_m2_;
        MovedWallPoint& target = result.emplace_back();
        target.position = center_ + scale * p + state.bow_m * rise * normal_;
        target.position_gradient = {rise * normal_, scale * p};
        // The surface z = bow rise(p) has the normal n - grad z.
        const Vec3 across = p - p.dot(normal_) * normal_;
        const Vec3 per_bow = 2.0 / (squared_radius_m2_ * scale) * across;
        const Vec3 tilted = points.normals[i] + state.bow_m * per_bow;
        target.normal = tilted.normalized();
        const auto gradient = [&](const Vec3& change) {
            return Vec3((change - target.normal.dot(change) * target.normal) / tilted.norm());
        };
        target.normal_gradient = {gradient(per_bow), gradient(-state.bow_m * per_bow)};
    }
    return result;
}

core::WallPoints WallMotion::moved_points(const core::WallPoints& points,
                                          const SceneState& state) const {
    core::WallPoints result = points;
    const std::vector<MovedWallPoint> moved_list = moved(points, state);
    for (std::size_t i = 0; i < points.size(); ++i) {
        result.positions[i] = moved_list[i].position;
        result.normals[i] = moved_list[i].normal;
    }
    return result;
}

}  // namespace calib
