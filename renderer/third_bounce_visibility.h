// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/piece_units.h"
#include "renderer/visibility_mask.h"
#include "renderer/wall_boxes.h"

#include <array>
#include <cstdint>
#include <memory>
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

/// What a wall point sees of the pieces.
struct VisiblePieces {
    std::vector<UnitMask> units;        ///< per block: those with pieces of which a part is seen
    std::vector<VisibilityMask> masks;  ///< block * kSize + lane, of these units; others: anything
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

    /// Sets `seen`; pieces that cannot matter are not.
    VisibilityCost trace(const WallPoint& point, const VisibilityRules& rules, VisiblePieces& seen);

 private:
    enum State : std::uint8_t { kIrrelevant, kBlocked, kVisible };
    struct Target {
        std::uint32_t piece;
        std::uint32_t bit;
    };
    /// Bit i: lane i of a block.
    struct BlockLanes {
        std::uint64_t relevant = 0;
        std::uint64_t visible = 0;  ///< of the relevant ones
    };
    struct alignas(64) BlockMasses {
        PieceBlock::Lanes of_lane;  ///< contribution to H if all visible
    };
    struct ActiveGroup {
        std::uint32_t group;
        std::uint32_t representative;  ///< the piece that its first ray goes to
    };
    /// The parts of a piece that its first rays go to, one in each quarter.
    struct FirstBits {
        std::uint32_t draw;
        std::uint32_t of_quarter(std::uint32_t q) const {
            return 4 * q + (draw >> (2 * q + 2) & 3U);
        }
        /// Whose ray comes before the others.
        std::uint32_t first_quarter() const { return draw & 3U; }
        std::uint32_t first() const { return of_quarter(first_quarter()); }
    };

    void classify(const VisibilityRules& rules);
    void classify_block(std::uint32_t block, const VisibilityRules& rules);
    LengthBounds path_lengths(std::uint32_t block, const VisibilityRules& rules) const;
    UnitMask units_within_axis(std::uint32_t block, const VisibilityRules& rules) const;
    std::uint64_t lanes_seen(std::uint32_t block, UnitMask units, const WallPoint& other);
    std::uint64_t lanes_within_axis(std::uint32_t block, const VisibilityRules& rules) const;
    inline FirstBits first_bits(std::uint32_t piece) const;
    void choose_representatives(std::uint32_t block);
    void trace_groups();
    void trace_pieces_of_mixed_groups(double negligible_error);
    void refine_mixed_pieces(double negligible_error, std::vector<VisibilityMask>& masks);
    State state_of(std::uint32_t piece) const;
    double mass_of(std::uint32_t piece) const {
        return masses_[piece / PieceBlock::kSize].of_lane[piece % PieceBlock::kSize];
    }
    void set_visible(std::uint32_t piece, bool is_visible);
    /// state_of_item   gives the state of the list's items
    template <class StateOf>
    static bool is_mixed(const NeighbourLists& lists,
                         std::uint32_t item,
                         const StateOf& state_of_item);
    /// Shoots at all targets; results_[i] is true where targets_[i] is seen.
    void shoot();

    const Scene& scene_;
    const PieceSet& set_;
    WallPoint point_;
    std::vector<State> group_states_;
    std::vector<BlockLanes> lanes_;          ///< per block
    std::unique_ptr<BlockMasses[]> masses_;  ///< per block, of relevant lanes
    std::vector<ActiveGroup> active_groups_;
    std::vector<std::uint32_t> active_blocks_;
    std::vector<std::uint32_t> opened_pieces_;
    std::vector<std::uint32_t> mixed_;
    std::vector<Target> targets_;
    std::vector<std::uint8_t> results_;
    VisibilityCost cost_;
};

}  // namespace renderer
