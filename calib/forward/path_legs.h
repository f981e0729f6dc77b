// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/wall_motion.h"
#include "renderer/triangle/triangle_histogram.h"

#include <cmath>

namespace calib {

/// One leg between a wall point w and a surface point x, d = x - w: its length, the factor
/// (n_w.d) |n.d| / |d|^4 and the gradients of both. The gradients by w are minus those by x.
struct Leg {
    double length = 0.0;
    double factor = 0.0;
    double side = 0.0;          ///< sign of n.d
    core::Vec3 direction;       ///< d/|d|
    core::Vec3 by_position;     ///< of the factor, by x
    core::Vec3 by_normal;       ///< by n
    core::Vec3 by_wall_normal;  ///< by n_w
};

/// The leg to a point x of a surface with this normal; gradients only with gradients.
inline Leg make_leg(const MovedWallPoint& wall,
                    const core::Vec3& x,
                    const core::Vec3& normal,
                    renderer::Gradients gradients) {
    const core::Vec3 d = x - wall.position;
    const double squared = d.squaredNorm();
    const double front = wall.normal.dot(d);
    const double facing = normal.dot(d);
    Leg leg;
    leg.length = std::sqrt(squared);
    leg.direction = d / leg.length;
    leg.side = facing < 0.0 ? -1.0 : 1.0;
    const double per4 = 1.0 / (squared * squared);
    const bool is_in_front = front > 0.0;
    leg.factor = is_in_front ? front * std::abs(facing) * per4 : 0.0;
    if (gradients == renderer::Gradients::Without) return leg;
    if (!is_in_front) {
        leg.by_position = leg.by_normal = leg.by_wall_normal = core::Vec3::Zero();
        return leg;
    }
    leg.by_position = per4 * (std::abs(facing) * wall.normal + front * leg.side * normal) -
                      4.0 * leg.factor / squared * d;
    leg.by_normal = front * leg.side * per4 * d;
    leg.by_wall_normal = std::abs(facing) * per4 * d;
    return leg;
}

/// The leg to an isotropic scatterer, whose factor is (n_w.d) / |d|^3. Leaves `by_normal` unset.
inline Leg make_point_leg(const MovedWallPoint& wall, const core::Vec3& x) {
    const core::Vec3 d = x - wall.position;
    const double squared = d.squaredNorm();
    const double front = wall.normal.dot(d);
    Leg leg;
    leg.length = std::sqrt(squared);
    leg.direction = d / leg.length;
    leg.by_position = leg.by_wall_normal = core::Vec3::Zero();
    if (!(front > 0.0)) return leg;
    const double per3 = 1.0 / (squared * leg.length);
    leg.factor = front * per3;
    leg.by_position = per3 * wall.normal - 3.0 * leg.factor / squared * d;
    leg.by_wall_normal = per3 * d;
    return leg;
}

/// The wall points of a pair.
struct PathEndpoints {
    const MovedWallPoint* light;
    const MovedWallPoint* sensor;
};

/// How a path's length and factor change with one parameter.
struct PathChange {
    double opl = 0.0;
    double factor = 0.0;
};

/// Both legs of a path by way of one surface point.
struct Path {
    double opl = 0.0;
    double factor = 0.0;
    Leg light;
    Leg sensor;
    core::Vec3 opl_by_position;
    core::Vec3 factor_by_position;
    core::Vec3 factor_by_normal;

    /// By the parameter of the wall whose gradients stand at `index`.
    PathChange by_wall(const PathEndpoints& ends, std::size_t index) const {
        const WallGradient& of_light = ends.light->gradients[index];
        const WallGradient& of_sensor = ends.sensor->gradients[index];
        return {-light.direction.dot(of_light.position) - sensor.direction.dot(of_sensor.position),
                sensor.factor * (light.by_wall_normal.dot(of_light.normal) -
                                 light.by_position.dot(of_light.position)) +
                    light.factor * (sensor.by_wall_normal.dot(of_sensor.normal) -
                                    sensor.by_position.dot(of_sensor.position))};
    }
};

/// The path of two legs: the sum of their lengths, the product of their factors.
inline Path join_legs(const Leg& light, const Leg& sensor, renderer::Gradients gradients) {
    Path path;
    path.opl = light.length + sensor.length;
    path.factor = light.factor * sensor.factor;
    if (gradients == renderer::Gradients::Without) return path;
    path.light = light;
    path.sensor = sensor;
    path.opl_by_position = light.direction + sensor.direction;
    path.factor_by_position = sensor.factor * light.by_position + light.factor * sensor.by_position;
    path.factor_by_normal = sensor.factor * light.by_normal + light.factor * sensor.by_normal;
    return path;
}

/// A retroreflector sends back one leg's factor.
inline Path retroreflected(const Leg& leg, renderer::Gradients gradients) {
    Leg mirror = leg;
    mirror.factor = 1.0;
    mirror.by_position = mirror.by_normal = mirror.by_wall_normal = core::Vec3::Zero();
    return join_legs(leg, mirror, gradients);
}

}  // namespace calib
