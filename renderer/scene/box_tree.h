// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace renderer {

/// Boxes that can be asked which of them meet another one, in double precision.
///
/// They stand in the order of a space-filling curve; over every kBranches of them is a box that
/// holds these, and so on up to few.
class BoxTree {
 public:
    using Box = Eigen::AlignedBox3d;

    /// boxes   none of them empty
    explicit BoxTree(const std::vector<Box>& boxes);

    /// Calls found(i) for every box i that meets or touches `box`, in no order.
    template <class Found>
    void find(const Box& box, const Found& found) const {
        find_in(levels_.size() - 1, 0, levels_.back().size(), box, found);
    }

 private:
    static constexpr std::size_t kBranches = 8;

    static bool meet(const Box& a, const Box& b) {
        return (a.min().array() <= b.max().array()).all() &&
               (b.min().array() <= a.max().array()).all();
    }

    template <class Found>
    void find_in(std::size_t level,
                 std::size_t begin,
                 std::size_t end,
                 const Box& box,
                 const Found& found) const {
        const std::vector<Box>& boxes = levels_[level];
        for (std::size_t i = begin; i < std::min(end, boxes.size()); ++i) {
            if (!meet(boxes[i], box)) continue;
            if (level == 0) {
                found(number_[i]);
            } else {
                find_in(level - 1, kBranches * i, kBranches * (i + 1), box, found);
            }
        }
    }

    std::vector<std::uint32_t> number_;     ///< of the boxes in the order of the curve
    std::vector<std::vector<Box>> levels_;  ///< the boxes themselves first
};

}  // namespace renderer
