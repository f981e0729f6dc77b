// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/geometry/wall_boxes.h"
#include "renderer/scene/scene.h"
#include "renderer/third_bounce/surface_elements.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace renderer {

/// How many elements a cut may have, and all cuts together may cost.
struct CutLimits {
    std::size_t in_all = 64'000'000;
    /// Or as many as the scene has facets. They take about 0.5 kB of memory each.
    std::size_t in_a_batch = 1'000'000;
    /// CPU time to integrate them [s], as counted by PilotRuns.
    double work_s = std::numeric_limits<double>::infinity();
};

/// Cuts the integrable hidden facets in front of a scan's points into elements.
class SurfaceSubdivider {
 public:
    /// scene, scan   must outlive the subdivider
    SurfaceSubdivider(const Scene& scene,
                      const core::WallScan& scan,
                      const core::TimeAxis& axis,
                      double laser_spot_m2,
                      const CutLimits& limits = {});

    /// Clips facets at the wall's plane and bisects them along their longest edge until length,
    /// falloff and cosines are linear enough over each element, as seen from the nearest wall
    /// point; leaves out what no pair can see within the axis. Smaller facets are merged where the
    /// bins do not tell them apart.
    ///
    /// The elements come in batches, in the order of facets, and are neither merged nor compared
    /// with those of other batches. A mesh too fine to be cut is one batch, so that it can be
    /// merged.
    ///
    /// tolerance   relative L2 error that the size rule aims at
    /// work        gets every batch, at least an empty one; false ends the cut
    /// throws      core::Failure, before any work, when there are more elements than the limits
    /// allow
    void cut(double tolerance, const std::function<bool(ElementSet&& batch)>& work) const;

    /// cut() makes at least this many elements.
    std::size_t min_elements(double tolerance) const;

 private:
    bool is_small_enough(const SegmentBounds& segments,
                         const core::Vec3& center,
                         double squared_edge,
                         double tolerance) const;
    /// All paths by way of what is seen at these distances have lengths within the axis.
    bool are_within_axis(const SegmentBounds& segments) const;
    /// At least this many elements cover a triangle, by the size rule at its farthest point; 0
    /// where some parts of it may be left out.
    double least_parts(const SurfaceElement& element,
                       const SegmentBounds& segments,
                       double tolerance) const;
    /// Where cutting stands.
    struct Cutting {
        struct Part {
            SurfaceElement triangle;
            int depth;
        };
        double tolerance;
        double facet_tolerance = 0.0;
        std::uint32_t next_facet = 0;
        std::uint32_t num_elements = 0;
        std::vector<Part> parts{};  ///< still to be looked at, the last one first
    };
    void begin_facet(Cutting& cutting) const;
    bool cut_next(Cutting& cutting, std::vector<SurfaceElement>& elements) const;
    double least_elements(double tolerance) const;
    using Batch = std::vector<SurfaceElement>;
    void cut_batches(double tolerance,
                     const std::function<bool(Batch& batch, std::size_t num_all)>& work) const;
    std::vector<std::uint32_t> cluster(std::span<const SurfaceElement> elements,
                                       double tolerance) const;

    const Scene& scene_;
    const core::WallScan& scan_;
    core::TimeAxis axis_;
    double laser_spot_m2_;
    CutLimits limits_;
    core::Vec3 origin_;
    bool returns_light_;  ///< retroreflectors do, to some point
    WallBoxes boxes_;
    std::vector<int> visible_sides_;  ///< per object
};

}  // namespace renderer
