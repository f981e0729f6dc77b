// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <cstddef>
#include <vector>

namespace nlos {

/// The closest point of a set for every query.
struct NearestNeighbours {
    std::vector<double> distances_m;   ///< one per query
    std::vector<std::size_t> indices;  ///< into `points`, one per query
};

/// Finds the exact nearest neighbour of every query in a k-d tree.
///
/// queries   where to search from [m]; may be empty
/// points    where to search; at least one [m]
/// source    FLANN [Muja2009], its single k-d tree with unlimited checks
NearestNeighbours nearest_neighbours(const std::vector<core::Vec3>& queries,
                                     const std::vector<core::Vec3>& points);

}  // namespace nlos
