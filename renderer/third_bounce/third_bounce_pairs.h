// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/time_axis.h"
#include "renderer/third_bounce/visibility_check.h"

#include <span>
#include <utility>
#include <vector>

namespace renderer {

/// What one end contributes to all paths by way of the visible elements of a block.
struct alignas(64) BlockTable {
    /// Length of the segment at the corners, and how it bends along the edges opposite to them, see
    /// TriangleLanes [m].
    std::array<ElementBlock::Lanes, 3> segment_m, bend_m;
    /// (n_w.d) |n_x.d| / |d|^4 at the nodes [1/m^2], 0 behind the wall point.
    std::array<ElementBlock::Lanes, ElementBlock::kNodes> factor;
    /// Distance of the wall point from the element's plane, above 0 on the normal's side [m].
    ElementBlock::Lanes side;
    SimdGroupMask simd_groups = 0;  ///< the others are not filled
};

/// Fills `table` for one wall point.
///
/// simd_groups   with elements visible from the point
void compute_table(const ElementBlock& block,
                   const WallPoint& point,
                   SimdGroupMask simd_groups,
                   BlockTable& table);

/// One end of the paths of a pair: the wall point, its table and its masks for one block.
struct PairEnd {
    const WallPoint* point;
    const BlockTable* table;
    const VisibilityMask* masks;  ///< of the block, see VisibleElements
};

/// Adds the third bounce of one measurement pair by way of one block to its histogram, wall albedos
/// left out.
///
/// light, sensor   the two ends; the same one twice for a confocal pair
/// axis            of the histogram, its start reduced by the pair's device segments
/// histogram       axis.num_bins values
void add_pair(const ElementBlock& block,
              const PairEnd& light,
              const PairEnd& sensor,
              const core::TimeAxis& axis,
              std::span<double> histogram);

/// Tables of some wall points for one block, where they see anything of it.
class TileTables {
 public:
    TileTables(std::vector<WallPoint> points, std::span<const VisibleElements> seen)
        : points_(std::move(points)), seen_(seen), tables_(points_.size()), ends_(points_.size()) {}

    void compute(const ElementBlock& block, std::size_t block_index) {
        for (std::size_t i = 0; i < points_.size(); ++i) {
            compute_table(block, points_[i], seen_[i].simd_groups[block_index], tables_[i]);
            ends_[i] = {&points_[i],
                        &tables_[i],
                        seen_[i].masks.data() + block_index * ElementBlock::kSize};
        }
    }

    const std::vector<PairEnd>& ends() const { return ends_; }
    VisibilityCheck::End end(std::size_t i) const { return {points_[i], seen_[i]}; }

 private:
    std::vector<WallPoint> points_;
    std::span<const VisibleElements> seen_;
    std::vector<BlockTable> tables_;
    std::vector<PairEnd> ends_;
};

}  // namespace renderer
