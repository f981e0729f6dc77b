// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/piece_units.h"
#include "renderer/shadow_rays.h"
#include "renderer/visibility_mask.h"
#include "renderer/wall_boxes.h"
#include "renderer/wall_point_lanes.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace renderer {

/// What limits the work of some wall points.
struct VisibilityRules {
    /// Lengths of the axis, device legs left out, per point or one for all.
    std::vector<LengthBounds> opl;
    /// The other end of the paths, or one that stands for all of them; empty: confocal.
    std::optional<WallPoint> other_end;
    /// Per block, bounds of the other end's leg; empty: there is only one other end.
    std::vector<LengthBounds> other_legs;
    double negligible_error = 0.0;  ///< errors of a value of H that need no more rays

    const LengthBounds& opl_of(std::size_t point) const { return opl[opl.size() > 1 ? point : 0]; }
};

/// What a wall point sees of the pieces.
struct VisiblePieces {
    std::vector<UnitMask> units;        ///< per block: those with pieces of which a part is seen
    std::vector<VisibilityMask> masks;  ///< block * kSize + lane, of these units; others: anything
    /// Expected, of H: of shadow edges that 16 rays leave uncertain.
    double squared_error = 0.0;
};

/// Finds what wall points see of the pieces, for several of them at once.
///
/// One ray goes from every point to each group, to a part of a piece that is drawn. Where
/// neighbouring groups disagree, each piece of theirs gets a ray, where neighbouring pieces
/// disagree, 4 and then 16: each step only if what the piece could add wrongly to H is not
/// negligible. What is known of a group or piece is one bit per point, so that all points are asked
/// by one operation.
class VisibilityTracer {
 public:
    /// scene, pieces   must outlive the tracer
    VisibilityTracer(const Scene& scene, const PieceSet& pieces);

    /// Sets `seen`; pieces that cannot matter are not.
    ///
    /// points   1 to WallPointLanes::kSize, best close to each other; what one of them sees does
    /// not
    ///          depend on the others
    /// seen     one per point
    void trace(std::span<const WallPoint> points,
               const VisibilityRules& rules,
               std::span<VisiblePieces> seen);

    std::uint64_t num_rays() const { return rays_.num_rays(); }
    /// What aiming rays, tracing them and reading the answers took.
    double tracing_seconds() const { return rays_.seconds(); }

 private:
    /// What is known of a group or a piece; `visible` is part of `relevant`.
    struct State {
        PointMask relevant = 0;
        PointMask visible = 0;
    };
    /// Pieces that neighbouring groups disagree about.
    struct Opened {
        std::uint32_t piece;
        PointMask points;
    };
    /// Pieces of which parts are seen.
    struct Refined {
        std::uint32_t piece;
        PointMask points;
        std::array<VisibilityMask, WallPointLanes::kSize> masks;
    };
    /// What a piece adds to H if all of it is seen, per point.
    struct alignas(64) Masses {
        WallPointLanes::Lanes of_point{};
    };
    /// Per lane of a block.
    using BlockPoints = std::array<PointMask, PieceBlock::kSize>;

    void classify();
    PointMask points_reaching(std::uint32_t block, PointMask& crossing) const;
    UnitMask units_within_axis(std::uint32_t block, std::size_t point) const;
    std::uint64_t lanes_within_axis(std::uint32_t block, std::size_t point) const;
    BlockPoints points_within_axis(std::uint32_t block,
                                   PointMask reaching,
                                   PointMask crossing) const;
    PointMask points_facing(const PieceBlock& block, std::size_t lane) const;
    Masses masses_of(std::uint32_t piece) const;
    PointMask points_that_matter(const Masses& masses, double share) const;
    void choose_representatives(std::uint32_t block);
    void trace_groups();
    void open_mixed_groups();
    void refine_mixed_pieces();
    void refine_quarters();
    static PointMask mixed_points(const NeighbourLists& lists,
                                  std::uint32_t item,
                                  const std::vector<State>& states);
    void write(std::span<VisiblePieces> seen) const;

    const PieceSet& set_;
    ShadowRayTracer rays_;
    WallPointLanes points_;
    const VisibilityRules* rules_ = nullptr;         ///< while trace() runs
    alignas(64) WallPointLanes::Lanes opl_begin_m_;  ///< per point
    alignas(64) WallPointLanes::Lanes opl_end_m_;
    std::vector<State> groups_;
    std::vector<State> pieces_;
    std::vector<PointMask> represented_;  ///< per piece: whose first ray to the group went to it
    std::vector<std::uint32_t> active_groups_;
    std::vector<std::uint32_t> active_blocks_;
    std::vector<ShadowRays> shadow_rays_;
    std::vector<Opened> opened_;
    std::vector<Refined> refined_;
    WallPointLanes::Lanes squared_errors_;
};

}  // namespace renderer
