// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/geometry/ellipsoid.h"

#include <cstdint>
#include <span>
#include <vector>

namespace renderer {

/// The fixed neighbours of a vertex to be placed, and the sides on which their surfaces reflect.
struct ConnectionEnds {
    FocusPair foci;
    core::Vec3 normal_a = core::Vec3::Zero();  ///< unit, towards the lit side; 0: all directions
    core::Vec3 normal_b = core::Vec3::Zero();
};

/// A facet drawn from a hierarchy.
struct FacetChoice {
    std::uint32_t facet = 0;
    double probability = 0.0;
    OplBand lengths;  ///< of the facet, within the interval asked for
};

/// A tree over the facets that ellipsoidal connections use, eight children per node.
///
/// A descent picks children with probabilities proportional to an estimate of their contribution:
/// area x fraction of their lengths within the interval x the four cosines / squared distances, or
/// 0 when bounds prove that there is none. Children are tested eight at a time in single precision,
/// relative to the centre of the set; all bounds are widened by more than its rounding.
class TriangleHierarchy {
 public:
    /// scene      must outlive the hierarchy
    /// facets     those to hold; others have probability 0
    /// sides      per object, which side can be seen: see visible_sides()
    TriangleHierarchy(const Scene& scene,
                      std::span<const std::uint32_t> facets,
                      std::span<const int> sides);

    bool empty() const { return order_.empty(); }

    /// Draws a facet whose lengths may lie in an interval.
    ///
    /// ends      neighbours of the vertex
    /// lengths   interval of |a - x| + |x - b| [m]
    /// u         uniform in [0, 1)
    /// returns   the facet; nothing when the descent ends where no facet can contribute
    std::optional<FacetChoice> sample(const ConnectionEnds& ends,
                                      const OplBand& lengths,
                                      double u) const;

    /// The choice that sample() makes of a given facet; probability 0 when it cannot be drawn.
    FacetChoice evaluate(const ConnectionEnds& ends,
                         const OplBand& lengths,
                         std::uint32_t facet) const;

    /// The part of an interval that a facet's lengths cover; empty (width 0) when there is none.
    OplBand part_of(const OplBand& lengths, const FocusPair& foci, std::uint32_t facet) const;

 private:
    friend class HierarchyCut;

    static constexpr int kWidth = 8;
    using Lanes = Eigen::Array<float, kWidth, 1>;

    struct Node {
        std::array<Lanes, 3> center;
        std::array<Lanes, 3> half_size;
        std::array<Lanes, 3> axis;  ///< mean normal
        Lanes spread;               ///< how far normals lie from the axis, as a chord
        Lanes two_sided;            ///< 1 when facets may be lit on either side, else 0
        Lanes area;                 ///< [m^2]; 0: no child
        Lanes radius;               ///< half the diagonal
        std::array<std::int32_t, kWidth> child;  ///< node, or ~position of a facet in order_
    };
    /// Ends and interval in the hierarchy's frame and precision.
    struct QueryEnd {
        Eigen::Vector3f focus = Eigen::Vector3f::Zero();
        Eigen::Vector3f normal = Eigen::Vector3f::Zero();
        float base = 0.0F;  ///< 1 for an end without a normal, else 0
    };
    struct Query {
        QueryEnd a, b;
        float apart = 0.0F;  ///< distance of the foci
        float from = 0.0F;   ///< interval
        float to = 0.0F;
        bool coincide = false;
    };
    struct NodeSlot {
        std::int32_t node = -1;  ///< -1: none
        std::int32_t slot = 0;
    };
    struct Builder;

    Query make_query(const ConnectionEnds& ends, const OplBand& lengths) const;

    struct NodeView;
    static NodeView view_of(const Node& node, const QueryEnd& end);
    Lanes importance(const Node& node, const Query& query) const;
    static std::array<float, kWidth + 1> cumulate(const Lanes& weights);
    /// The choice that sample() makes from `node` on, which is come to with a probability.
    std::optional<FacetChoice> draw_below(std::int32_t node,
                                          const Query& query,
                                          const FocusPair& foci,
                                          const OplBand& lengths,
                                          double u,
                                          double probability) const;
    /// Probability that the descent from `top` ends at a facet; 0 when it lies elsewhere.
    double descent_probability(std::int32_t top, const Query& query, std::uint32_t facet) const;

    const Scene* scene_;
    core::Vec3 origin_ = core::Vec3::Zero();
    float margin_m_ = 0.0F;  ///< of lengths and box sizes, above the rounding of both
    std::vector<Node> nodes_;
    std::vector<NodeSlot> parents_;          ///< of every node
    std::vector<std::uint32_t> order_;       ///< facets in the order of the leaves
    std::vector<NodeSlot> slots_;            ///< of every facet of the scene
    std::vector<std::uint32_t> positions_;   ///< in order_, of every facet of the scene
    std::vector<std::uint32_t> first_leaf_;  ///< per node, position of its first facet
    std::vector<float> sides_;               ///< per facet of the scene
};

}  // namespace renderer
