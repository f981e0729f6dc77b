// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/material.h"
#include "renderer/third_bounce/vec3_lanes.h"
#include "renderer/triangle/triangle_histogram.h"

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace renderer {

/// All responses of elements, in the order in which blocks of them are packed.
inline constexpr std::array kElementResponses{
    ElementResponse{}, ElementResponse{.glossy = true}, ElementResponse{.towards_source = true}};

/// A flat triangle small enough for the closed-form kernel; positions relative to
/// ElementSet::origin.
struct SurfaceElement {
    std::array<core::Vec3, 3> corners;
    std::uint32_t facet = 0;
    std::uint32_t number = 0;  ///< in the order of facets, whatever rounding does to sorting

    core::Vec3 center() const { return (corners[0] + corners[1] + corners[2]) / 3.0; }
    /// Midpoint of the edge from corner i to the next one.
    core::Vec3 midpoint(std::size_t i) const { return 0.5 * (corners[i] + corners[(i + 1) % 3]); }
};

/// Elements of one response, laid out for vectorised loops. Nodes 0-2 are the corners, 3-5 the
/// midpoints of the edges that start there, node 6 is the centre.
struct alignas(64) ElementBlock {
    static constexpr std::size_t kSize = TriangleLanes::kSize;
    static constexpr std::size_t kSimdWidth = core::Simd::size();
    static constexpr std::size_t kNumSimdGroups = kSize / kSimdWidth;
    static constexpr std::size_t kNodes = 7;
    using Lanes = TriangleLanes::Lanes;

    std::array<Vec3Lanes<kSize>, 3> corners;  ///< relative to ElementSet::origin [m]
    Vec3Lanes<kSize> normal, center;
    Lanes area_m2;
    Lanes rise_m;  ///< the surface lies at most this far above or below the triangle
    std::array<Lanes, 3> squared_edge;  ///< opposite to the corners [m^2]
    Lanes one_sided;                    ///< +-1: only this side of the normal is visible; 0: both
    std::array<Lanes, kNodes> reflectance;  ///< at the nodes; albedo/pi or albedo/spot area
    Lanes mean_reflectance;                 ///< of glossy elements for light from all sides
    Lanes glossy_alpha;                     ///< GGX width, set for glossy elements only
    std::array<std::uint32_t, kSize> facet;
    std::array<std::uint32_t, kSize> random_bits;  ///< from SurfaceElement::number
    ElementResponse response;
    std::size_t count = 0;  ///< lanes beyond it repeat lane 0 with area 0
    double longest_edge_m = 0.0;
    /// Spheres that hold the corners of each SIMD group.
    Vec3Lanes<kNumSimdGroups> simd_group_center;
    alignas(64) std::array<double, kNumSimdGroups> simd_group_radius_m;
};

/// A set of SIMD groups of a block, runs of ElementBlock::kSimdWidth consecutive lanes: group u is
/// bit u.
using SimdGroupMask = std::uint32_t;

inline constexpr SimdGroupMask kAllSimdGroups =
    (SimdGroupMask{1} << ElementBlock::kNumSimdGroups) - 1;

/// Calls work(i) for each bit i that is set, in order.
template <class Work>
void for_each_bit(std::uint64_t bits, const Work& work) {
    for (; bits != 0; bits &= bits - 1) work(static_cast<std::size_t>(std::countr_zero(bits)));
}

/// Calls work(first lane) for each SIMD group.
template <class Work>
void for_each_simd_group(SimdGroupMask simd_groups, const Work& work) {
    for_each_bit(simd_groups,
                 [&](std::size_t simd_group) { work(simd_group * ElementBlock::kSimdWidth); });
}

/// Weights of corners, edge midpoints and the centre in the mean of a function over a triangle;
/// exact for cubic functions.
inline constexpr double kFractionOfCorner = 1.0 / 20.0;
inline constexpr double kFractionOfMiddle = 2.0 / 15.0;
inline constexpr double kFractionOfCenter = 9.0 / 20.0;

/// Holds the corners of all elements of a block; relative to ElementSet::origin.
struct BlockSphere {
    core::Vec3 center;
    double radius_m = 0.0;
};

/// Neighbouring elements of one object that one shadow ray may stand for: a run of a block's lanes.
struct VisibilityGroup {
    std::uint32_t block = 0;
    std::uint64_t lanes = 0;  ///< lane i as bit i
};

/// Lists of neighbours: those of item i are items[begin[i] .. begin[i + 1]).
struct AdjacencyLists {
    std::vector<std::uint32_t> begin;
    std::vector<std::uint32_t> items;

    std::span<const std::uint32_t> of(std::size_t item) const {
        return std::span(items).subspan(begin[item], begin[item + 1] - begin[item]);
    }
};

/// The hidden surfaces cut into elements, or a batch of these, element i in lane i % kSize of block
/// i / kSize.
struct ElementSet {
    core::Vec3 origin = core::Vec3::Zero();  ///< world; keeps precision far from the world's origin
    std::vector<ElementBlock> blocks;
    std::vector<BlockSphere> spheres;  ///< per block, close together in memory
    std::vector<VisibilityGroup> groups;
    std::vector<std::uint32_t> first_group;  ///< per block, and one past the last
    AdjacencyLists element_neighbours;       ///< elements that share an edge
    AdjacencyLists group_neighbours;
    std::size_t num_elements = 0;
    std::uint32_t first_number = 0;  ///< SurfaceElement::number of the batch's first element
    double fraction = 1.0;           ///< of all elements of the cut before any were merged
};

}  // namespace renderer
