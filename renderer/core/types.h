// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace core {

/// Points, directions and normals; lengths in metres, directions unit length.
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// Rigid or affine maps named `b_from_a`.
using Transform = Eigen::Affine3d;

/// Speed of light in vacuum [m/s].
inline constexpr double kSpeedOfLight = 299792458.0;

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegreesPerRadian = 180.0 / kPi;

/// Optical path length travelled during `seconds` [m].
inline constexpr double opl_from_seconds(double seconds) {
    return seconds * kSpeedOfLight;
}

/// An orthonormal basis whose third column is `normal` (unit) and whose first lies along the part
/// of `tangent` across it; `tangent` must not be parallel to `normal`.
///
/// Given a tangent that belongs to the scene, samples rotate with the scene.
inline Mat3 frame_from_normal(const Vec3& normal, const Vec3& tangent) {
    Mat3 frame;
    frame.col(0) = (tangent - normal.dot(tangent) * normal).normalized();
    frame.col(1) = normal.cross(frame.col(0));
    frame.col(2) = normal;
    return frame;
}

}  // namespace core
