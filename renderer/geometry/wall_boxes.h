// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <optional>
#include <utility>
#include <vector>

namespace renderer {

/// Smallest and largest of a set of lengths [m].
struct LengthBounds {
    double min_m = 0.0;
    double max_m = 0.0;
};

/// Distances of a sphere's points from all illumination and from all sensing points.
struct SegmentBounds {
    LengthBounds light;
    LengthBounds sensor;
};

/// The points of a scan in a few boxes, to bound their distances from a part of the scene.
class WallBoxes {
 public:
    /// origin       what positions are relative to [m, world]
    /// rounding_m   of the positions, by which points of one plane may lie beside it
    WallBoxes(const core::WallScan& scan, const core::Vec3& origin, double rounding_m);

    SegmentBounds segments(const core::Vec3& center, double radius) const;
    /// The exact least distances from points to a sphere, which segments() only bounds.
    std::pair<double, double> nearest_light_and_sensor_m(const core::Vec3& center,
                                                         double radius) const;
    /// No point is farther than this from the nearest corner of its box [m].
    double slack_m() const { return slack_m_; }

    /// Bounds of the lengths of the device segments of all pairs.
    const LengthBounds& device_segments() const { return device_segments_; }

    /// True when a sphere lies behind all wall points' tangent planes.
    bool is_behind(const core::Vec3& center, double radius) const;

    /// The plane that holds all points, with their normal: (n, n.x). Nothing on curved walls.
    const std::optional<std::pair<core::Vec3, double>>& common_plane() const { return plane_; }

 private:
    struct Boxes {
        Eigen::ArrayX3d lower, upper;           ///< corners
        Eigen::ArrayX3d points;                 ///< box by box
        std::vector<Eigen::Index> first_point;  ///< per box, and one past the last
    };

    void find_planes(const core::WallPoints& points, const core::Vec3& origin, double rounding_m);
    static Boxes make_boxes(const core::WallPoints& points, const core::Vec3& origin);
    static LengthBounds bounds(const Boxes& boxes, const core::Vec3& center, double radius);
    static double nearest(const Boxes& boxes, const core::Vec3& center, double radius);

    bool confocal_;
    Boxes light_;
    Boxes sensor_;
    double slack_m_ = 0.0;
    LengthBounds device_segments_;
    std::vector<std::pair<core::Vec3, double>> planes_;  ///< distinct tangent planes
    std::optional<std::pair<core::Vec3, double>> plane_;
};

}  // namespace renderer
