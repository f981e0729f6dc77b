// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

#include <cmath>

namespace calib {

/// How far the wall's centre stands before its corners: points rise along the mean normal by
/// bow (1 - |p|^2 / R^2), R the distance of the farthest point from the centre.
inline const Parameter kWallBow{
    .name = "wall.bow",
    .owner = Owner::Scene,
    .effect = Effect::MovesWall,
    .key = "wall.bow_m",
    .misfit = {"the wall's bow", 1e3, "mm"},
    .move_wall = [](double bow_m, const WallPosition& at, MovedWallPoint& point) {
        const core::Vec3& p = at.from_center_m;
        const double rise = 1.0 - p.squaredNorm() / at.squared_radius_m2;
        const core::Vec3 across = p - p.dot(at.wall_normal) * at.wall_normal;
        // The surface z = bow rise(p) has the normal n - grad z.
        const core::Vec3 tilt = 2.0 / at.squared_radius_m2 * across;
        point.position += bow_m * rise * at.wall_normal;
        point.normal += bow_m * tilt;
        point.gradients.push_back({rise * at.wall_normal, tilt});
    }};

/// Of wall points about their centre. Behind what lifts the wall, whose slopes it makes flatter.
inline const Parameter kWallScale{
    .name = "wall.scale",
    .owner = Owner::Scene,
    .effect = Effect::MovesWall,
    .is_logarithm = true,
    .key = "wall.scale",
    .misfit = {"the wall's scale", 100.0, "%"},
    .move_wall = [](double log_scale, const WallPosition& at, MovedWallPoint& point) {
        const double scale = std::exp(log_scale);
        const core::Vec3 tilt = (point.normal - at.start_normal) / scale;
        point.position += (scale - 1.0) * at.from_center_m;
        point.normal = at.start_normal + tilt;
        for (WallGradient& gradient : point.gradients) gradient.normal /= scale;
        point.gradients.push_back({scale * at.from_center_m, -tilt});
    }};

}  // namespace calib
