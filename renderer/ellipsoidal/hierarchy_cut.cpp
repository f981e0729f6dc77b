// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal/hierarchy_cut.h"

#include "renderer/core/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {

using core::Vec3;

void HierarchyCut::rebuild(const ConnectionEnds& ends,
                           const OplBand& lengths,
                           std::size_t max_entries) {
    ends_ = ends;
    lengths_ = lengths;
    entries_.clear();
    if (hierarchy_->empty() || !(lengths.width_m() > 0.0)) return;
    query_ = hierarchy_->make_query(ends, lengths);
    TriangleHierarchy::Query everything = query_;
    everything.from = 0.0F;
    everything.to = std::numeric_limits<float>::max();
    const TriangleHierarchy::Node& root = hierarchy_->nodes_.front();
    const float all = hierarchy_->importance(root, everything).sum();
    fraction_asked_ = all > 0.0F ? double{hierarchy_->importance(root, query_).sum() / all} : 0.0;
    entries_.push_back({0, 0, 1.0, 0.0, {}});
    while (expand(max_entries)) {
    }
    double sum = 0.0;
    for (const Entry& entry : entries_) sum += entry.weight;
    if (!(sum > 0.0)) {
        entries_.clear();
        return;
    }
    double end = 0.0;
    for (Entry& entry : entries_) {
        end += entry.weight / sum;
        entry.end = end;
    }
    entries_.back().end = 1.0;
}

// Replaces every node by its children, in the order of their facets; false when there is none left
// or there are enough entries.
bool HierarchyCut::expand(std::size_t max_entries) {
    const bool has_node =
        std::any_of(entries_.begin(), entries_.end(), [](const Entry& e) { return e.child >= 0; });
    if (!has_node || entries_.size() >= max_entries) return false;
    next_.clear();
    for (const Entry& entry : entries_) {
        if (entry.child >= 0) {
            append_children(entry.child);
        } else {
            next_.push_back(entry);
        }
    }
    entries_.swap(next_);
    return true;
}

void HierarchyCut::append_children(std::int32_t node) {
    const TriangleHierarchy::Node& at = hierarchy_->nodes_[static_cast<std::size_t>(node)];
    const TriangleHierarchy::Lanes weights = hierarchy_->importance(at, query_);
    for (std::int32_t slot = 0; slot < TriangleHierarchy::kWidth; ++slot) {
        if (!(weights[slot] > 0.0F)) continue;
        Entry entry;
        entry.child = at.child[static_cast<std::size_t>(slot)];
        if (entry.child >= 0) {
            entry.first = hierarchy_->first_leaf_[static_cast<std::size_t>(entry.child)];
            entry.weight = double{weights[slot]};
        } else {
            entry.first = static_cast<std::uint32_t>(~entry.child);
            entry.weight = facet_weight(hierarchy_->order_[entry.first], entry.lengths);
        }
        if (entry.weight > 0.0) next_.push_back(entry);
    }
}

// Estimated contribution of a facet: its area within the interval times cosines and falloff at a
// point of its plane in the direction of the centroid that has the wanted length. It is 0 only
// where the contribution is: a facet partly below an end's horizon keeps a part.
double HierarchyCut::facet_weight(std::uint32_t index, OplBand& lengths) const {
    const Facet& facet = hierarchy_->scene_->facet(index);
    const double lit_side = double{hierarchy_->sides_[index]};
    const double side_a = facet.normal.dot(ends_.foci.a - facet.corner);
    const double side_b = query_.coincide ? side_a : facet.normal.dot(ends_.foci.b - facet.corner);
    if (!(side_a * side_b > 0.0) || lit_side * side_a < 0.0) return 0.0;

    const OplBand band = opl_band(ends_.foci, facet);
    lengths.low_m = std::max(band.low_m, lengths_.low_m);
    lengths.high_m = std::min(band.high_m, lengths_.high_m);
    if (!(lengths.width_m() > 0.0)) return 0.0;
    const Vec3 arm = (facet.edge1 + facet.edge2) / 3.0;
    const double asked = 0.5 * (lengths.low_m + lengths.high_m);
    const double scale = asked / ends_.foci.opl_m(facet.corner + arm);
    const double least2 = std::min(facet.area_m2, 0.0625 * asked * asked);
    const auto end_factor = [&](const Vec3& focus, const Vec3& normal, double side) {
        const Vec3 from_end = facet.corner - focus;
        const double side2 = side * side;
        const double centroid2 = (from_end + arm).squaredNorm();
        const double distance2 = std::max(least2, scale * scale * centroid2);
        if (normal.isZero(0.0)) return std::abs(side) / (std::sqrt(distance2) * distance2);
        // Heights above the end's horizon, linear in the distance from the foot of the focus.
        const double height = normal.dot(from_end);
        const double highest =
            height + std::max({0.0, normal.dot(facet.edge1), normal.dot(facet.edge2)});
        const double at_foot = -side * normal.dot(facet.normal);
        const double offset2 = centroid2 - side2;
        const double ratio =
            offset2 > 0.0 ? std::sqrt(std::max(0.0, distance2 - side2) / offset2) : 1.0;
        const double there = at_foot + ratio * (height + normal.dot(arm) - at_foot);
        const double mean = std::max(std::min(there, highest), 0.1 * highest);
        return mean > 0.0 ? std::abs(side) * mean / (distance2 * distance2) : 0.0;
    };
    const double at_a = end_factor(ends_.foci.a, ends_.normal_a, side_a);
    if (!(at_a > 0.0)) return 0.0;
    const double at_b = query_.coincide ? at_a : end_factor(ends_.foci.b, ends_.normal_b, side_b);
    return facet.area_m2 * lengths.width_m() / band.width_m() * at_a * at_b;
}

double HierarchyCut::fraction(std::size_t entry) const {
    return entries_[entry].end - (entry == 0 ? 0.0 : entries_[entry - 1].end);
}

std::optional<FacetChoice> HierarchyCut::sample(double u, std::size_t& hint) const {
    while (hint + 1 < entries_.size() && u >= entries_[hint].end) ++hint;
    const Entry& entry = entries_[hint];
    const double probability = fraction(hint);
    if (entry.child < 0) {
        return FacetChoice{hierarchy_->order_[entry.first], probability, entry.lengths};
    }
    const double begin = entry.end - probability;
    const double rest = std::clamp((u - begin) / probability, 0.0, core::kBelowOne);
    return hierarchy_->draw_below(entry.child, query_, ends_.foci, lengths_, rest, probability);
}

FacetChoice HierarchyCut::evaluate(std::uint32_t facet) const {
    FacetChoice choice{facet, 0.0, {}};
    if (entries_.empty() || hierarchy_->slots_[facet].node < 0) return choice;
    // The last entry that begins at or before the facet, if it holds it.
    const std::uint32_t position = hierarchy_->positions_[facet];
    auto after = std::upper_bound(
        entries_.begin(), entries_.end(), position, [](std::uint32_t value, const Entry& entry) {
            return value < entry.first;
        });
    if (after == entries_.begin()) return choice;
    const auto index = static_cast<std::size_t>(after - entries_.begin()) - 1;
    const Entry& entry = entries_[index];
    if (entry.child < 0) {
        if (entry.first != position) return choice;
        choice.probability = fraction(index);
        choice.lengths = entry.lengths;
        return choice;
    }
    choice.lengths = hierarchy_->part_of(lengths_, ends_.foci, facet);
    if (!(choice.lengths.width_m() > 0.0)) return choice;
    choice.probability =
        fraction(index) * hierarchy_->descent_probability(entry.child, query_, facet);
    return choice;
}

}  // namespace renderer
