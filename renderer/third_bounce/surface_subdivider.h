// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/geometry/wall_boxes.h"
#include "renderer/scene/scene.h"
#include "renderer/third_bounce/surface_elements.h"

#include <cstdint>
#include <span>
#include <vector>

namespace renderer {

/// Cuts the integrable hidden facets in front of a scan's points into elements.
class SurfaceSubdivider {
 public:
    /// scene, scan   must outlive the subdivider
    SurfaceSubdivider(const Scene& scene,
                      const core::Scan& scan,
                      const core::TimeAxis& axis,
                      double laser_spot_m2);

    /// Clips facets at the wall's plane and bisects them along their longest edge until length,
    /// falloff and cosines are linear enough over each element, as seen from the nearest wall
    /// point; leaves out what no pair can see within the axis. Smaller facets are merged where the
    /// bins do not tell them apart.
    ///
    /// tolerance   relative L2 error that the size rule aims at
    ElementSet cut(double tolerance) const;

    /// cut() makes at least this many elements.
    std::size_t min_elements(double tolerance) const;

 private:
    bool is_small_enough(const LegBounds& legs,
                         const core::Vec3& center,
                         double squared_edge,
                         double tolerance) const;
    /// At least this many elements cover a triangle, by the size rule at its farthest point.
    double least_parts(const SurfaceElement& element,
                       const LegBounds& legs,
                       double tolerance) const;
    void bisect(const SurfaceElement& facet,
                double tolerance,
                std::vector<SurfaceElement>& elements) const;
    std::vector<SurfaceElement> cut_all(double tolerance) const;
    std::vector<std::uint32_t> cluster(std::span<const SurfaceElement> elements,
                                       double tolerance) const;

    const Scene& scene_;
    const core::Scan& scan_;
    core::TimeAxis axis_;
    double laser_spot_m2_;
    core::Vec3 origin_;
    bool returns_light_;  ///< retroreflectors do, to some point
    WallBoxes boxes_;
    std::vector<int> visible_sides_;  ///< per object, see closed_surface.h
};

}  // namespace renderer
