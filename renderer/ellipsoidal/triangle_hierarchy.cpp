// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal/triangle_hierarchy.h"

#include "renderer/core/sampling.h"
#include "renderer/ellipsoidal/facet_split.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

// Relative to the size of the set: above the rounding of coordinates and of lengths.
constexpr double kMargin = 4e-6;
// Added to the spread of normals: above the rounding of cosines.
constexpr float kSpreadMargin = 1e-3F;
// Shortest segment assumed, relative to the radius of a box that may contain its end.
constexpr float kNearestSegment = 0.1F;
// Deepest level with unbalanced cuts; below it sets are halved, so that facets which cannot be told
// apart end.
constexpr int kDeepestCut = 40;

Eigen::AlignedBox3d box_of(const Facet& facet) {
    Eigen::AlignedBox3d box;
    for (const Vec3& corner : facet.corners()) box.extend(corner);
    return box;
}

}  // namespace

struct TriangleHierarchy::Builder {
    using Range = std::span<std::uint32_t>;

    TriangleHierarchy& tree;
    std::span<const Facet> facets;

    std::int32_t add_node(Range range, NodeSlot parent, std::uint32_t first, int depth) {
        const auto index = static_cast<std::int32_t>(tree.nodes_.size());
        tree.nodes_.emplace_back();
        tree.parents_.push_back(parent);
        tree.first_leaf_.push_back(first);
        const std::vector<Range> parts = split_facets(range, facets, kWidth, depth > kDeepestCut);
        std::uint32_t position = first;
        for (std::int32_t slot = 0; slot < kWidth; ++slot) {
            const auto part_index = static_cast<std::size_t>(slot);
            const bool used = part_index < parts.size();
            fill_slot(tree.nodes_[static_cast<std::size_t>(index)],
                      slot,
                      used ? parts[part_index] : Range());
            if (!used) continue;
            const Range part = parts[part_index];
            std::int32_t child = 0;
            if (part.size() == 1) {
                child = ~static_cast<std::int32_t>(position);
                tree.order_.push_back(part[0]);
                tree.slots_[part[0]] = {index, slot};
                tree.positions_[part[0]] = position;
            } else {
                child = add_node(part, {index, slot}, position, depth + 1);
            }
            tree.nodes_[static_cast<std::size_t>(index)].child[part_index] = child;
            position += static_cast<std::uint32_t>(part.size());
        }
        return index;
    }

    // Facets that may be lit on either side count with the normal that agrees with the first.
    void fill_slot(Node& node, std::int32_t slot, Range range) const {
        Eigen::AlignedBox3d box;
        double area = 0.0;
        bool two_sided = false;
        Vec3 sum = Vec3::Zero();
        for (const std::uint32_t f : range) {
            box.extend(box_of(facets[f]));
            area += facets[f].area_m2;
            two_sided = two_sided || tree.sides_[f] == 0.0F;
            sum += facets[f].area_m2 * lit_normal(f, sum);
        }
        Vec3 axis = Vec3::UnitZ();
        if (sum.norm() > 1e-6 * area) axis = sum.normalized();
        double spread = 0.0;
        for (const std::uint32_t f : range) {
            spread = std::max(spread, (lit_normal(f, axis) - axis).norm());
        }
        const Vec3 center = range.empty() ? Vec3::Zero() : Vec3(box.center() - tree.origin_);
        const Vec3 half = range.empty() ? Vec3::Zero() : Vec3(0.5 * box.sizes());
        for (std::size_t k = 0; k < 3; ++k) {
            const auto i = static_cast<Eigen::Index>(k);
            node.center[k][slot] = static_cast<float>(center[i]);
            node.half_size[k][slot] = static_cast<float>(half[i]) + tree.margin_m_;
            node.axis[k][slot] = static_cast<float>(axis[i]);
        }
        node.spread[slot] = static_cast<float>(spread) + kSpreadMargin;
        node.two_sided[slot] = two_sided ? 1.0F : 0.0F;
        node.area[slot] = static_cast<float>(area);
        node.radius[slot] = static_cast<float>(half.norm()) + 2.0F * tree.margin_m_;
        node.child[static_cast<std::size_t>(slot)] = 0;
    }

    Vec3 lit_normal(std::uint32_t facet, const Vec3& like) const {
        const Vec3& normal = facets[facet].normal;
        const float side = tree.sides_[facet];
        if (side != 0.0F) return side * normal;
        return normal.dot(like) < 0.0 ? Vec3(-normal) : normal;
    }
};

TriangleHierarchy::TriangleHierarchy(const Scene& scene,
                                     std::span<const std::uint32_t> facets,
                                     std::span<const int> sides)
    : scene_(&scene), slots_(scene.facets().size()), positions_(scene.facets().size()) {
    for (const Facet& facet : scene.facets()) {
        sides_.push_back(static_cast<float>(sides[facet.object]));
    }
    if (facets.empty()) return;
    Eigen::AlignedBox3d box;
    for (const std::uint32_t f : facets) box.extend(box_of(scene.facet(f)));
    // The ends lie in the scene, if not in the set.
    Eigen::AlignedBox3d all = box;
    for (const Facet& facet : scene.facets()) all.extend(box_of(facet));
    origin_ = box.center();
    margin_m_ = static_cast<float>(kMargin * all.sizes().norm());
    order_.reserve(facets.size());
    std::vector<std::uint32_t> ids(facets.begin(), facets.end());
    Builder{*this, scene.facets()}.add_node(ids, {}, 0, 0);
}

// Bounds over a node's boxes as seen from one end.
struct TriangleHierarchy::NodeView {
    std::array<Lanes, 3> gap;  ///< to the box along each axis
    Lanes nearest = Lanes::Zero();
    Lanes farthest = Lanes::Zero();
    Lanes along_axis = Lanes::Zero();
    Lanes above_end = Lanes::Zero();
};

TriangleHierarchy::NodeView TriangleHierarchy::view_of(const Node& node, const QueryEnd& end) {
    NodeView view;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto i = static_cast<Eigen::Index>(k);
        const Lanes d = end.focus[i] - node.center[k];
        const Lanes size = d.abs();
        view.gap[k] = (size - node.half_size[k]).max(0.0F);
        view.nearest += view.gap[k].square();
        view.farthest += (size + node.half_size[k]).square();
        view.along_axis += node.axis[k] * d;
        view.above_end += std::abs(end.normal[i]) * node.half_size[k] - end.normal[i] * d;
    }
    view.nearest = view.nearest.sqrt();
    view.farthest = view.farthest.sqrt();
    return view;
}

// Bounds over a box with centre c, d = focus - c. For a normal n within the chord `spread` of the
// axis m, n.(focus - x) <= m.d + (half the box along m) + spread |focus - x|: a facet can face the
// focus only where that is positive, and likewise for the part above an end's horizon. Values other
// than 0 are estimates, for segments whose sum is the middle of the lengths asked for and whose
// product is that of the shortest and the longest: on a facet that is large compared with its
// distance, they are the segments to the part that has the length.
TriangleHierarchy::Lanes TriangleHierarchy::importance(const Node& node, const Query& q) const {
    Lanes half_along_axis = Lanes::Zero();
    for (std::size_t k = 0; k < 3; ++k) half_along_axis += node.axis[k].abs() * node.half_size[k];
    const NodeView a = view_of(node, q.a);
    const NodeView b = q.coincide ? a : view_of(node, q.b);

    Lanes low = a.nearest + b.nearest;
    if (!q.coincide) {
        // The two segments together are at least as long as one whose extent along each axis is the
        // sum of theirs.
        Lanes straight2 = Lanes::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
            const auto i = static_cast<Eigen::Index>(k);
            straight2 += (a.gap[k] + b.gap[k]).max(std::abs(q.a.focus[i] - q.b.focus[i])).square();
        }
        low = low.max(straight2.sqrt());
    }
    low -= margin_m_;
    const Lanes high = a.farthest + b.farthest + margin_m_;
    const Lanes from = low.max(q.from);
    const Lanes to = high.min(q.to);
    const Lanes length = 0.5F * (from + to);
    const Lanes shortest_a = a.nearest.max(length - b.farthest).max(0.5F * (length - q.apart));
    const Lanes longest_a =
        a.farthest.min(length - b.nearest).min(0.5F * (length + q.apart)).max(shortest_a);
    const Lanes least2 = (kNearestSegment * node.radius).square();
    const Lanes inverse_a = (shortest_a * longest_a).max(least2).rsqrt();
    const Lanes inverse_b = ((length - shortest_a) * (length - longest_a)).max(least2).rsqrt();

    const auto cosine = [](const Lanes& value) -> Lanes { return value.max(0.0F).min(1.0F); };
    const Lanes slack_a = half_along_axis + node.spread * a.farthest;
    const Lanes slack_b = half_along_axis + node.spread * b.farthest;
    const Lanes front =
        cosine((slack_a + a.along_axis) * inverse_a) * cosine((slack_b + b.along_axis) * inverse_b);
    const Lanes back = node.two_sided * cosine((slack_a - a.along_axis) * inverse_a) *
                       cosine((slack_b - b.along_axis) * inverse_b);
    const Lanes at_a = cosine(a.above_end * inverse_a + q.a.base);
    const Lanes at_b = cosine(b.above_end * inverse_b + q.b.base);
    const Lanes falloff = (inverse_a * inverse_b).square();
    return node.area * ((to - from).max(0.0F) / (high - low)) * front.max(back) * at_a * at_b *
           falloff;
}

TriangleHierarchy::Query TriangleHierarchy::make_query(const ConnectionEnds& ends,
                                                       const OplBand& lengths) const {
    Query query;
    const auto end = [&](const Vec3& focus, const Vec3& normal) {
        return QueryEnd{(focus - origin_).cast<float>(),
                        normal.cast<float>(),
                        normal.isZero(0.0) ? 1.0F : 0.0F};
    };
    query.a = end(ends.foci.a, ends.normal_a);
    query.b = end(ends.foci.b, ends.normal_b);
    query.apart = static_cast<float>((ends.foci.a - ends.foci.b).norm());
    query.from = static_cast<float>(lengths.low_m) - margin_m_;
    query.to = static_cast<float>(lengths.high_m) + margin_m_;
    query.coincide = ends.foci.a == ends.foci.b && ends.normal_a == ends.normal_b;
    return query;
}

// Cumulative sums of the children's weights, from 0; rounding keeps their order. Probabilities are
// differences of these rounded numbers, so that they are exactly those of a descent.
std::array<float, TriangleHierarchy::kWidth + 1> TriangleHierarchy::cumulate(const Lanes& w) {
    const float first2 = w[0] + w[1];
    const float first4 = first2 + (w[2] + w[3]);
    const float first6 = first4 + (w[4] + w[5]);
    return {0.0F,
            w[0],
            first2,
            first2 + w[2],
            first4,
            first4 + w[4],
            first6,
            first6 + w[6],
            first6 + w[6] + w[7]};
}

std::optional<FacetChoice> TriangleHierarchy::draw_below(std::int32_t node,
                                                         const Query& query,
                                                         const FocusPair& foci,
                                                         const OplBand& lengths,
                                                         double u,
                                                         double probability) const {
    while (node >= 0) {
        const Node& at = nodes_[static_cast<std::size_t>(node)];
        const std::array<float, kWidth + 1> ends = cumulate(importance(at, query));
        const float sum = ends[kWidth];
        if (!(sum > 0.0F)) return std::nullopt;
        // The last fraction that begins at or before the target; fractions of 0 are never the last.
        const double target = u * double{sum};
        const float below = std::min(static_cast<float>(target), std::nextafter(sum, 0.0F));
        std::size_t chosen = 0;
        for (std::size_t i = 1; i < kWidth; ++i) chosen += ends[i] <= below ? 1 : 0;
        const double fraction = double{ends[chosen + 1]} - double{ends[chosen]};
        u = std::clamp((target - double{ends[chosen]}) / fraction, 0.0, core::kBelowOne);
        probability *= fraction / double{sum};
        node = at.child[chosen];
    }
    const std::uint32_t facet = order_[static_cast<std::uint32_t>(~node)];
    const FacetChoice choice{facet, probability, part_of(lengths, foci, facet)};
    return choice.lengths.width_m() > 0.0 ? std::optional(choice) : std::nullopt;
}

double TriangleHierarchy::descent_probability(std::int32_t top,
                                              const Query& query,
                                              std::uint32_t facet) const {
    double probability = 1.0;
    NodeSlot node_slot = slots_[facet];
    while (true) {
        if (node_slot.node < 0) return 0.0;
        const Node& at = nodes_[static_cast<std::size_t>(node_slot.node)];
        const std::array<float, kWidth + 1> ends = cumulate(importance(at, query));
        const auto slot = static_cast<std::size_t>(node_slot.slot);
        const double fraction = double{ends[slot + 1]} - double{ends[slot]};
        if (!(fraction > 0.0)) return 0.0;
        probability *= fraction / double{ends[kWidth]};
        if (node_slot.node == top) return probability;
        node_slot = parents_[static_cast<std::size_t>(node_slot.node)];
    }
}

OplBand TriangleHierarchy::part_of(const OplBand& lengths,
                                   const FocusPair& foci,
                                   std::uint32_t facet) const {
    const OplBand band = opl_band(foci, scene_->facet(facet));
    const double low = std::max(band.low_m, lengths.low_m);
    return {low, std::max(low, std::min(band.high_m, lengths.high_m))};
}

std::optional<FacetChoice> TriangleHierarchy::sample(const ConnectionEnds& ends,
                                                     const OplBand& lengths,
                                                     double u) const {
    if (empty()) return std::nullopt;
    return draw_below(0, make_query(ends, lengths), ends.foci, lengths, u, 1.0);
}

FacetChoice TriangleHierarchy::evaluate(const ConnectionEnds& ends,
                                        const OplBand& lengths,
                                        std::uint32_t facet) const {
    if (slots_[facet].node < 0) return {facet, 0.0, {}};
    FacetChoice choice{facet, 0.0, part_of(lengths, ends.foci, facet)};
    if (!(choice.lengths.width_m() > 0.0)) return choice;
    choice.probability = descent_probability(0, make_query(ends, lengths), facet);
    return choice;
}

}  // namespace renderer
