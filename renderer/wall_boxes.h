// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"

#include <optional>
#include <utility>
#include <vector>

namespace renderer {

/// Smallest and largest of a set of lengths [m].
struct LengthBounds {
    double least_m = 0.0;
    double most_m = 0.0;
};

/// The points of a scan in a few boxes, to bound their distances from a part of the scene.
class WallBoxes {
 public:
    /// origin   what positions are relative to [m, world]
    WallBoxes(const core::Scan& scan, const core::Vec3& origin);

    /// Bounds of the distances from illumination points to points of a sphere.
    LengthBounds light_legs(const core::Vec3& center, double radius) const;
    /// Bounds of the distances from sensing points to points of a sphere.
    LengthBounds sensor_legs(const core::Vec3& center, double radius) const;
    /// Distances from the nearest illumination point and the nearest sensing point to a sphere, exact
    /// where *_legs() only bounds them.
    std::pair<double, double> nearest_m(const core::Vec3& center, double radius) const;
    /// Bounds of the optical path lengths over the sphere, device legs included.
    LengthBounds path_lengths(const core::Vec3& center, double radius) const;

    /// True when a point lies behind all wall points' tangent planes by more than `radius`.
    bool is_behind(const core::Vec3& center, double radius) const;

    /// The plane that holds all points with their normal: (n, n.x). Nothing on curved walls.
    const std::optional<std::pair<core::Vec3, double>>& common_plane() const { return plane_; }

 private:
    /// Consecutive points, and the box around them.
    struct Run {
        Eigen::AlignedBox3d box;
        std::vector<core::Vec3> points;
    };
    using Runs = std::vector<Run>;
    static Runs make_runs(const core::WallPoints& points, const core::Vec3& origin);
    static LengthBounds legs(const Runs& runs, const core::Vec3& center, double radius);
    static double nearest(const Runs& runs, const core::Vec3& center, double radius);

    bool confocal_;
    Runs light_;
    Runs sensor_;
    LengthBounds device_legs_;
    std::vector<std::pair<core::Vec3, double>> planes_;  ///< distinct tangent planes
    std::optional<std::pair<core::Vec3, double>> plane_;
};

}  // namespace renderer
