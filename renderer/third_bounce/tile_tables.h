// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/third_bounce/third_bounce_pairs.h"
#include "renderer/third_bounce/visibility_check.h"

#include <span>
#include <utility>
#include <vector>

namespace renderer {

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
