// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <algorithm>
#include <cstddef>
#include <span>

namespace renderer {

/// Orders items so that the first `num_first` lie before the others along the box's longest side.
///
/// box           of the items' positions
/// position_of   gives an item's position
template <class Item, class PositionOf>
void split_along_longest_side(std::span<Item> items,
                              std::size_t num_first,
                              const Eigen::AlignedBox3d& box,
                              const PositionOf& position_of) {
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    std::nth_element(
        items.begin(),
        items.begin() + static_cast<std::ptrdiff_t>(num_first),
        items.end(),
        [&](const Item& a, const Item& b) { return position_of(a)[axis] < position_of(b)[axis]; });
}

}  // namespace renderer
