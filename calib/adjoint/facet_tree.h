// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"
#include "renderer/core/simd.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace calib {

/// A tree of neighbouring facets of a mesh, for bounds that depend on where it is seen from.
class FacetTree {
 public:
    /// A leaf holds `count` facets from position `first` of order() on; another node, whose count
    /// is 0, has the nodes `first` and `first` + 1 as children, which come after it.
    struct Node {
        std::uint32_t first = 0;
        std::uint32_t count = 0;
    };

    explicit FacetTree(const core::TriangleMesh& mesh);

    std::span<const Node> nodes() const { return nodes_; }
    std::span<const std::uint32_t> order() const { return order_; }

 private:
    void build(const std::vector<core::Vec3>& centers,
               std::uint32_t node,
               std::uint32_t first,
               std::uint32_t count);

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_;  ///< facets, leaf by leaf
};

/// Where triangles lie before a wall point: a box in the perspective picture of what is before it,
/// and how near to the wall it begins and ends. Touching boxes do not overlap.
struct alignas(64) ViewBox {
    /// Least u, v and distance from the wall [m], then the negatives of the largest ones.
    std::array<double, core::Simd::size()> bounds{};

    void extend(const ViewBox& other) {
        store(core::min(core::load(bounds, 0), core::load(other.bounds, 0)), bounds, 0);
    }
};

/// What is looked for: boxes with all bounds below these.
struct alignas(64) ViewQuery {
    std::array<double, core::Simd::size()> bounds;

    /// Boxes that overlap this one, reach before the wall, and begin before this one ends.
    explicit ViewQuery(const ViewBox& box)
        : bounds{-box.bounds[3],
                 -box.bounds[4],
                 -box.bounds[5],
                 -box.bounds[0],
                 -box.bounds[1],
                 0.0,
                 1.0,
                 1.0} {}

    bool matches(const ViewBox& box) const {
        return !(core::load(bounds, 0) <= core::load(box.bounds, 0)).any();
    }
};

/// The boxes of a tree's facets before one wall point.
class ViewBoxes {
 public:
    /// tree   must outlive this
    explicit ViewBoxes(const FacetTree& tree) : tree_(tree) {}

    /// wall_normal   unit
    /// vertices      of the mesh, relative to the wall point
    void look(const core::Vec3& wall_normal,
              const core::TriangleMesh& mesh,
              std::span<const core::Vec3> vertices);

    /// corners   relative to the wall point
    ViewBox box_of(const std::array<core::Vec3, 3>& corners) const;
    const ViewBox& box_of_facet(std::uint32_t facet) const { return facets_[facet]; }
    /// Finds the facets that may hide some of what a box holds, in rising order.
    void find(const ViewBox& box, std::vector<std::uint32_t>& found) const;

 private:
    const FacetTree& tree_;
    core::Mat3 wall_from_world_;
    std::vector<ViewBox> facets_;
    std::vector<ViewBox> nodes_;
};

}  // namespace calib
