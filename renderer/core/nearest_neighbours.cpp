// SPDX-License-Identifier: MIT
#include "renderer/core/nearest_neighbours.h"

#include <flann/flann.hpp>

#include <cassert>
#include <cmath>

namespace core {
namespace {

constexpr int kLeafSize = 10;

/// FLANN's interface wants writable rows, but does not write to them.
flann::Matrix<double> rows_of(const std::vector<Vec3>& points) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    return {const_cast<double*>(points.front().data()), points.size(), 3};
}

}  // namespace

NearestNeighbours nearest_neighbours(const std::vector<Vec3>& queries,
                                     const std::vector<Vec3>& points,
                                     std::size_t count) {
    assert(points.size() >= count);
    NearestNeighbours result;
    result.distances_m.resize(queries.size() * count);
    result.indices.resize(queries.size() * count);
    if (queries.empty()) return result;

    flann::Index<flann::L2_Simple<double>> tree(rows_of(points),
                                                flann::KDTreeSingleIndexParams(kLeafSize));
    tree.buildIndex();
    flann::Matrix<std::size_t> indices(result.indices.data(), queries.size(), count);
    flann::Matrix<double> squared(result.distances_m.data(), queries.size(), count);
    tree.knnSearch(rows_of(queries),
                   indices,
                   squared,
                   count,
                   flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
    for (double& distance : result.distances_m) distance = std::sqrt(distance);
    return result;
}

}  // namespace core
