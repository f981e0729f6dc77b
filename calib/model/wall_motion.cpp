// SPDX-License-Identifier: MIT
#include "calib/model/wall_motion.h"

#include "calib/model/parameter.h"

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
    std::vector<std::pair<const Parameter*, double>> rows;
    for (const Parameter* row : parameters()) {
        if (row->effect == Effect::MovesWall) rows.emplace_back(row, row->numbers(state)[0]);
    }
    std::vector<MovedWallPoint> result;
    result.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const WallPosition at{
            points.positions[i] - center_, points.normals[i], normal_, squared_radius_m2_};
        MovedWallPoint& target = result.emplace_back();
        target.position = center_ + at.from_center_m;
        target.normal = at.start_normal;
        for (const auto& [row, number] : rows) row->move_wall(number, at, target);
        const double length = target.normal.norm();
        target.normal.normalize();
        for (WallGradient& gradient : target.gradients) {
            const Vec3& change = gradient.normal;
            gradient.normal = (change - target.normal.dot(change) * target.normal) / length;
        }
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
