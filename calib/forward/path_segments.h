// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/wall_motion.h"
#include "renderer/triangle/triangle_histogram.h"

#include <cmath>

namespace calib {

/// One segment between a wall point w and a surface point x, d = x - w: its length, the factor
/// (n_w.d) |n.d| / |d|^4 and the gradients of both. The gradients by w are minus those by x.
struct Segment {
    double length = 0.0;
    double factor = 0.0;
    double side = 0.0;          ///< sign of n.d
    core::Vec3 direction;       ///< d/|d|
    core::Vec3 by_position;     ///< of the factor, by x
    core::Vec3 by_normal;       ///< by n
    core::Vec3 by_wall_normal;  ///< by n_w
};

/// The segment to a point x of a surface with this normal; gradients only with gradients.
inline Segment make_segment(const MovedWallPoint& wall,
                            const core::Vec3& x,
                            const core::Vec3& normal,
                            renderer::Gradients gradients) {
    const core::Vec3 d = x - wall.position;
    const double squared = d.squaredNorm();
    const double front = wall.normal.dot(d);
    const double facing = normal.dot(d);
    Segment segment;
    segment.length = std::sqrt(squared);
    segment.direction = d / segment.length;
    segment.side = facing < 0.0 ? -1.0 : 1.0;
    const double per4 = 1.0 / (squared * squared);
    const bool is_in_front = front > 0.0;
    segment.factor = is_in_front ? front * std::abs(facing) * per4 : 0.0;
    if (gradients == renderer::Gradients::Without) return segment;
    if (!is_in_front) {
        segment.by_position = segment.by_normal = segment.by_wall_normal = core::Vec3::Zero();
        return segment;
    }
    segment.by_position = per4 * (std::abs(facing) * wall.normal + front * segment.side * normal) -
                          4.0 * segment.factor / squared * d;
    segment.by_normal = front * segment.side * per4 * d;
    segment.by_wall_normal = std::abs(facing) * per4 * d;
    return segment;
}

/// The segment to an isotropic scatterer, whose factor is (n_w.d) / |d|^3. Leaves `by_normal`
/// unset.
inline Segment make_point_segment(const MovedWallPoint& wall, const core::Vec3& x) {
    const core::Vec3 d = x - wall.position;
    const double squared = d.squaredNorm();
    const double front = wall.normal.dot(d);
    Segment segment;
    segment.length = std::sqrt(squared);
    segment.direction = d / segment.length;
    segment.by_position = segment.by_wall_normal = core::Vec3::Zero();
    if (!(front > 0.0)) return segment;
    const double per3 = 1.0 / (squared * segment.length);
    segment.factor = front * per3;
    segment.by_position = per3 * wall.normal - 3.0 * segment.factor / squared * d;
    segment.by_wall_normal = per3 * d;
    return segment;
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

/// Both segments of a path by way of one surface point.
struct Path {
    double opl = 0.0;
    double factor = 0.0;
    Segment light;
    Segment sensor;
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

/// The path of two segments: the sum of their lengths, the product of their factors.
inline Path join_segments(const Segment& light,
                          const Segment& sensor,
                          renderer::Gradients gradients) {
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

/// A retroreflector sends back one segment's factor.
inline Path retroreflected(const Segment& segment, renderer::Gradients gradients) {
    Segment mirror = segment;
    mirror.factor = 1.0;
    mirror.by_position = mirror.by_normal = mirror.by_wall_normal = core::Vec3::Zero();
    return join_segments(segment, mirror, gradients);
}

}  // namespace calib
