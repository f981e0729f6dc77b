// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/depth_map.h"

#include <algorithm>
#include <cstddef>

namespace nlos {

/// Calls visit(jx, jy) for the foreground columns at most `reach` columns from (ix, iy) along x and
/// along y, itself included.
template <class Visit>
void visit_near(const core::DepthMap& depth,
                std::size_t ix,
                std::size_t iy,
                std::size_t reach,
                const Visit& visit) {
    const std::size_t end_x = std::min(depth.x_m.size(), ix + reach + 1);
    const std::size_t end_y = std::min(depth.y_m.size(), iy + reach + 1);
    for (std::size_t jx = ix - std::min(ix, reach); jx < end_x; ++jx) {
        for (std::size_t jy = iy - std::min(iy, reach); jy < end_y; ++jy) {
            if (depth.is_foreground(depth.index(jx, jy))) visit(jx, jy);
        }
    }
}

}  // namespace nlos
