// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/geometry/wall_boxes.h"
#include "renderer/third_bounce/surface_elements.h"
#include "renderer/third_bounce/wall_point_lanes.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace renderer {

/// Where shadow rays go.
enum class ShadowRayPlan {
    WhereNeighboursDisagree,  ///< one to each group of elements, more to edges of shadows
    Everywhere                ///< one to every part of every element, for shadows finer than these
};

/// What is known of the paths from some wall points, and the error allowed.
struct VisibilityRules {
    /// Path lengths within the axis without the device segments, per point or one for all.
    std::vector<LengthBounds> opl;
    /// The other end of the paths, or one that stands for all of them; empty: confocal.
    std::optional<WallPoint> other_end;
    /// Per block, bounds of the other end's segment; empty: there is only one other end.
    std::vector<LengthBounds> other_segments;
    double negligible_error = 0.0;  ///< error of a value of H below which no more rays are traced
    /// Number of pairs of each point; retroreflectors return light in one of them.
    double pairs_per_point = 1.0;
    ShadowRayPlan plan = ShadowRayPlan::WhereNeighboursDisagree;

    const LengthBounds& opl_of(std::size_t point) const { return opl[opl.size() > 1 ? point : 0]; }
};

/// Which elements can contribute to the paths from some wall points, visibility ignored, and how
/// much.
class RelevantElements {
 public:
    /// What an element adds to H if it is fully visible, per point.
    struct alignas(64) Masses {
        WallPointLanes::Lanes of_point{};
    };
    /// Points per lane of a block.
    using BlockPoints = std::array<PointMask, ElementBlock::kSize>;

    /// elements   must outlive this
    explicit RelevantElements(const ElementSet& elements) : set_(elements) {}

    /// rules   must outlive all queries about these points
    void look_from(const WallPointLanes& points, const VisibilityRules& rules);

    /// Per element, the points that it faces with a reflecting side on paths within the axis.
    BlockPoints of_block(std::uint32_t block) const;
    Masses masses_of(std::uint32_t element) const;

 private:
    PointMask points_reaching(std::uint32_t block, PointMask& crossing) const;
    SimdGroupMask simd_groups_within_axis(std::uint32_t block, std::size_t point) const;
    std::uint64_t lanes_within_axis(std::uint32_t block, std::size_t point) const;
    BlockPoints points_within_axis(std::uint32_t block,
                                   PointMask reaching,
                                   PointMask crossing) const;
    PointMask points_facing(const ElementBlock& block, std::size_t lane) const;

    const ElementSet& set_;
    WallPointLanes points_;
    const VisibilityRules* rules_ = nullptr;
    alignas(64) WallPointLanes::Lanes opl_begin_m_;  ///< per point
    alignas(64) WallPointLanes::Lanes opl_end_m_;
};

}  // namespace renderer
