// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "renderer/core/capture.h"

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
    /// Bounds of the optical path lengths over the sphere, device legs included.
    LengthBounds path_lengths(const core::Vec3& center, double radius) const;

    /// True when a point lies behind all wall points' tangent planes by more than `radius`.
    bool is_behind(const core::Vec3& center, double radius) const;

    /// The plane that holds all points with their normal: (n, n.x). Nothing on curved walls.
    const std::optional<std::pair<core::Vec3, double>>& common_plane() const { return plane_; }

   private:
    using Boxes = std::vector<Eigen::AlignedBox3d>;
    static Boxes make_boxes(const core::WallPoints& points, const core::Vec3& origin);
    static LengthBounds legs(const Boxes& boxes, const core::Vec3& center, double radius);

    bool confocal_;
    Boxes light_;
    Boxes sensor_;
    LengthBounds device_legs_;
    std::vector<std::pair<core::Vec3, double>> sensor_planes_;  ///< distinct tangent planes
    std::optional<std::pair<core::Vec3, double>> plane_;
};

}  // namespace renderer
