// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/piece_units.h"
#include "renderer/visibility_mask.h"
#include "renderer/wall_boxes.h"

#include <array>
#include <cstdint>
#include <vector>

namespace renderer {

/// A wall point as the integrator sees it; position relative to PieceSet::origin.
struct WallPoint {
    core::Vec3 position;
    core::Vec3 normal;
    std::uint32_t index = 0;  ///< among the points of its side
};

/// What limits the work of one wall point.
struct VisibilityRules {
    double opl_begin_m = 0.0;  ///< of the axis, device legs left out
    double opl_end_m = 0.0;
    WallPoint other_end;  ///< the other end of the paths, or one that stands for all of them
    /// Per block, bounds of the other end's leg; empty: `other_end` is the only one.
    std::vector<LengthBounds> other_legs;
    double negligible_error = 0.0;  ///< errors of a value of H that need no more rays
};

/// What a look around took, and how good it is.
struct VisibilityCost {
    std::uint64_t num_rays = 0;
    double tracing_seconds = 0.0;  ///< aiming rays, tracing them, reading the answers
    double squared_error = 0.0;    ///< expected, of H: of shadow edges that 16 rays leave uncertain
};

/// Finds what wall points see of the pieces.
///
/// One ray goes to each group, to a part of a piece that is drawn anew for every wall point: of
/// shadows that cover less than half of many pieces, as bumps cast, fixed parts would see nothing.
/// Where neighbouring groups disagree, each piece of theirs gets a ray, where neighbouring pieces
/// disagree, 4 and then 16: each step only if what the piece could add wrongly to H is not
/// negligible.
class VisibilityTracer {
 public:
    /// scene, pieces   must outlive the tracer
    VisibilityTracer(const Scene& scene, const PieceSet& pieces);

    /// Sets masks[block * kSize + lane] for all pieces; 0 for what cannot matter.
    VisibilityCost trace(const WallPoint& point,
                         const VisibilityRules& rules,
                         std::vector<VisibilityMask>& masks);

 private:
    enum State : std::uint8_t { kIrrelevant, kBlocked, kVisible };
    struct Target {
        std::uint32_t piece;
        std::uint32_t bit;
    };

    void classify(const VisibilityRules& rules);
    void classify_block(std::uint32_t block, const VisibilityRules& rules);
    LengthBounds path_lengths(std::uint32_t block, const VisibilityRules& rules) const;
    UnitMask units_within_axis(std::uint32_t block, const VisibilityRules& rules) const;
    std::uint64_t lanes_seen(std::uint32_t block, UnitMask units, const WallPoint& other);
    std::uint64_t lanes_within_axis(std::uint32_t block, const VisibilityRules& rules) const;
    void choose_representatives(std::uint32_t block, std::uint64_t relevant);
    /// The parts of a piece that its first rays go to, one in each quarter.
    struct FirstBits {
        std::array<std::uint32_t, 4> of_quarter;
        std::uint32_t first_quarter;  ///< whose ray comes before the others
        std::uint32_t first() const { return of_quarter[first_quarter]; }
    };
    FirstBits first_bits(std::uint32_t piece) const;
    void trace_groups();
    void trace_pieces_of_mixed_groups(double negligible_error);
    void refine_mixed_pieces(double negligible_error, std::vector<VisibilityMask>& masks);
    bool is_mixed(const NeighbourLists& lists,
                  const std::vector<State>& states,
                  std::uint32_t item) const;
    /// Shoots at all targets; results_[i] is true where targets_[i] is seen.
    void shoot();

    const Scene& scene_;
    const PieceSet& set_;
    WallPoint point_;
    std::vector<State> group_states_;
    std::vector<State> piece_states_;
    std::vector<double> piece_mass_;  ///< contribution to H if all visible
    std::vector<std::uint32_t> representative_;
    std::vector<std::uint32_t> active_groups_;
    std::vector<std::uint32_t> active_blocks_;
    std::vector<std::uint32_t> opened_pieces_;
    std::vector<std::uint32_t> mixed_;
    std::vector<Target> targets_;
    std::vector<std::uint8_t> results_;
    VisibilityCost cost_;
};

}  // namespace renderer
