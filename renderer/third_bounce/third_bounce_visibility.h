// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/third_bounce/piece_units.h"
#include "renderer/third_bounce/relevant_pieces.h"
#include "renderer/third_bounce/shadow_rays.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace renderer {

/// What a wall point sees of the pieces.
struct VisiblePieces {
    std::vector<UnitMask> units;        ///< per block: those with pieces of which a part is seen
    std::vector<VisibilityMask> masks;  ///< block * kSize + lane, of these units; others: anything
    /// Expected, of H, in all pairs of the point: of shadow edges that 16 rays leave uncertain.
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
    ///          not depend on the others
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

    void classify();
    PointMask points_that_matter(const RelevantPieces::Masses& masses, double share) const;
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
    RelevantPieces relevant_;
    ShadowRayTracer rays_;
    double negligible_error_ = 0.0;
    double pairs_per_point_ = 1.0;
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
