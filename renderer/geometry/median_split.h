// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace renderer {

/// Orders items so that the first `num_first` lie before the others along the box's longest side.
///
/// Positions nearer together than a millionth of that side go by the other sides, and sides as
/// nearly equal by their number: what rounding decides would differ from one place of the world to
/// another.
///
/// box           of the items' positions
/// position_of   gives an item's position
template <class Item, class PositionOf>
void split_along_longest_side(std::span<Item> items,
                              std::size_t num_first,
                              const Eigen::AlignedBox3d& box,
                              const PositionOf& position_of) {
    constexpr double kTie = 1e-6;
    Eigen::Index axis = 0;
    for (Eigen::Index side = 1; side < 3; ++side) {
        if (box.sizes()[side] > (1.0 + kTie) * box.sizes()[axis]) axis = side;
    }
    const double per_m = 1.0 / std::max(kTie * box.sizes()[axis], 1e-300);
    const auto step = [&](const Item& item, Eigen::Index side) {
        return std::floor((position_of(item)[side] - box.min()[side]) * per_m + 0.5);
    };
    std::nth_element(items.begin(),
                     items.begin() + static_cast<std::ptrdiff_t>(num_first),
                     items.end(),
                     [&](const Item& a, const Item& b) {
                         for (Eigen::Index i = 0; i < 3; ++i) {
                             const double step_a = step(a, (axis + i) % 3);
                             const double step_b = step(b, (axis + i) % 3);
                             if (step_a != step_b) return step_a < step_b;
                         }
                         return false;
                     });
}

}  // namespace renderer
