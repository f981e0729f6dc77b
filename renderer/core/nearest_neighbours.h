// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <cstddef>
#include <vector>

namespace core {

/// The closest points of a set for every query.
struct NearestNeighbours {
    std::vector<double> distances_m;   ///< (queries, count), nearest first
    std::vector<std::size_t> indices;  ///< into `points`, likewise
};

/// Finds the exact nearest neighbours of every query in a k-d tree.
///
/// queries   where to search from [m]; may be empty
/// points    where to search; at least `count` [m]
/// count     neighbours per query, at least 1
/// source    FLANN [Muja2009], its single k-d tree with unlimited checks
NearestNeighbours nearest_neighbours(const std::vector<Vec3>& queries,
                                     const std::vector<Vec3>& points,
                                     std::size_t count = 1);

}  // namespace core
