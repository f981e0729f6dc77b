// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/third_bounce/relevant_elements.h"
#include "renderer/third_bounce/shadow_rays.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace renderer {

/// The visible parts of the elements from one wall point.
struct VisibleElements {
    std::vector<SimdGroupMask>
        simd_groups;  ///< per block: those with partly or fully visible elements
    std::vector<VisibilityMask>
        masks;  ///< [block * kSize + lane], for these SIMD groups; undefined for others
    /// Expected squared error of H, over all pairs of the point, at shadow edges that 16 rays do
    /// not resolve.
    double squared_error = 0.0;
};

/// Finds the visible parts of the elements from several wall points at once.
///
/// One ray goes from every point to each group, to a randomly drawn part of one of its elements.
/// Where neighbouring groups disagree, each of their elements gets a ray; where neighbouring
/// elements disagree, 4 and then 16 rays, each step only if the possible error of H is not
/// negligible. Shadows that fall between the rays to neighbours go unseen:
/// ShadowRayPlan::Everywhere sends 16 rays to all elements instead. The state of a group or element
/// is one bit per point, so that one operation covers all points.
class VisibilityTracer {
 public:
    /// scene, elements   must outlive the tracer
    VisibilityTracer(const Scene& scene, const ElementSet& elements);

    /// Sets `seen`; elements that cannot contribute count as invisible.
    ///
    /// points   1 to WallPointLanes::kSize, preferably close to each other; the result for one does
    ///          not depend on the others
    /// seen     one per point
    void trace(std::span<const WallPoint> points,
               const VisibilityRules& rules,
               std::span<VisibleElements> seen);

    const TracingCost& cost() const { return rays_.cost(); }

 private:
    /// Standard deviation of the visible fraction of an element that a shadow's straight edge
    /// crosses, known from one part drawn of 16, from one drawn in each quarter, and from all 16
    /// [found by simulation].
    static constexpr double kErrorFromOne = 0.34;
    static constexpr double kErrorFromQuarters = 0.12;
    static constexpr double kErrorFromSixteenths = 0.03;

    /// The state of a group or an element; `visible` is a subset of `relevant`.
    struct State {
        PointMask relevant = 0;
        PointMask visible = 0;
    };
    /// Elements that neighbouring groups disagree about.
    struct Opened {
        std::uint32_t element;
        PointMask points;
    };
    /// Elements that may be partly visible.
    struct Refined {
        std::uint32_t element;
        PointMask points;
        std::array<VisibilityMask, WallPointLanes::kSize> masks;
    };

    void classify();
    PointMask points_that_matter(const RelevantElements::Masses& masses, double fraction) const;
    void choose_representatives(std::uint32_t block);
    void trace_groups();
    void open_mixed_groups();
    void refine_mixed_elements();
    void refine_quarters();
    void trace_all_parts();
    void note_refined(const Refined& refined);
    void add_squared_error(const Refined& refined, PointMask points);
    void trace_sixteenths(std::span<const std::size_t> refined_of_rays);
    static PointMask mixed_points(const AdjacencyLists& lists,
                                  std::uint32_t item,
                                  const std::vector<State>& states);
    void write(std::span<VisibleElements> seen) const;

    const ElementSet& set_;
    RelevantElements relevant_;
    ShadowRayTracer rays_;
    double negligible_error_ = 0.0;
    double pairs_per_point_ = 1.0;
    std::vector<State> groups_;
    std::vector<State> elements_;
    std::vector<PointMask> represented_;  ///< per element: whose first ray to the group went to it
    std::vector<std::uint32_t> active_groups_;
    std::vector<std::uint32_t> active_blocks_;
    std::vector<ShadowRays> shadow_rays_;
    std::vector<Opened> opened_;
    std::vector<Refined> refined_;
    WallPointLanes::Lanes squared_errors_;
};

}  // namespace renderer
