// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"
#include "renderer/third_bounce/surface_elements.h"

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace renderer {

/// An element as it is integrated: itself, or a triangle that stands for several elements with the
/// same area, centroid and second moments in its plane.
struct ElementCluster {
    SurfaceElement triangle;  ///< with one of the facets
    core::Vec3 normal;
    double area_m2 = 0.0;
    double rise_m = 0.0;  ///< the surface lies at most this far above or below the triangle's plane
};

/// Merged elements, and where each of the elements went.
struct ElementClusters {
    std::vector<ElementCluster> elements;
    std::vector<std::uint32_t> merged_of;  ///< per element, index into `elements`
};

/// Limits of a cluster.
struct ClusterLimits {
    double diameter_m = 0.0;
    double squared_tilt = 0.0;  ///< mean of |normal - mean normal|^2
};

/// Splits the elements of each object at medians until each part may be merged; elements of glossy
/// and textured objects stay single.
///
/// elements        sorted by object
/// may_be_merged   asked about the bounding sphere of a part within the limits
/// returns         a cluster number per element, counted from 0
std::vector<std::uint32_t> cluster_elements(
    const Scene& scene,
    std::span<const SurfaceElement> elements,
    const ClusterLimits& limits,
    const std::function<bool(const core::Vec3& center, double diameter_m)>& may_be_merged);

/// Merges connected elements of the same cluster.
///
/// clusters   per element
/// touching   pairs of elements, see adjacent_elements()
ElementClusters merge_elements(const Scene& scene,
                               std::span<const SurfaceElement> elements,
                               std::span<const std::uint32_t> clusters,
                               std::span<const std::pair<std::uint32_t, std::uint32_t>> touching);

/// Pairs of elements (indices into `elements`) that share an edge, or of which one has half an edge
/// of the other. Positions must agree to the last bit, as those of one cut do.
std::vector<std::pair<std::uint32_t, std::uint32_t>> adjacent_elements(
    std::span<const SurfaceElement> elements);

/// The lists of both ends of every pair, without duplicates, in rising order.
AdjacencyLists adjacency_lists(std::size_t num_items,
                               const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs);

/// What packing depends on.
struct PackingRules {
    double tolerance = 0.01;  ///< relative L2 error aimed at
    double laser_spot_m2 = 1e-4;
    std::vector<int> visible_side;  ///< per object, see closed_surface.h
};

/// Merges elements and arranges them into blocks of neighbours and groups within blocks.
///
/// elements   freed, like `clusters`, as soon as they are merged
/// clusters   of elements that may be merged, see cluster_elements()
ElementSet pack_elements(const Scene& scene,
                         const core::WallScan& scan,
                         const PackingRules& rules,
                         std::vector<SurfaceElement>&& elements,
                         std::vector<std::uint32_t>&& clusters);

}  // namespace renderer
