// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/third_bounce_visibility.h"

#include <algorithm>
#include <bit>

namespace renderer {
namespace {

// Elements [begin, end).
struct BlockLanes {
    std::uint32_t begin;
    std::uint32_t end;
};

BlockLanes elements_of(const VisibilityGroup& group) {
    const auto begin = static_cast<std::uint32_t>(group.block * ElementBlock::kSize) +
                       static_cast<std::uint32_t>(std::countr_zero(group.lanes));
    return {begin, begin + static_cast<std::uint32_t>(std::popcount(group.lanes))};
}

}  // namespace

VisibilityTracer::VisibilityTracer(const Scene& scene, const ElementSet& elements)
    : set_(elements),
      relevant_(elements),
      rays_(scene, elements),
      groups_(elements.groups.size()),
      elements_(elements.blocks.size() * ElementBlock::kSize),
      represented_(elements_.size()) {}

void VisibilityTracer::trace(std::span<const WallPoint> points,
                             const VisibilityRules& rules,
                             std::span<VisibleElements> seen) {
    const WallPointLanes lanes(points);
    relevant_.look_from(lanes, rules);
    rays_.look_from(lanes);
    negligible_error_ = rules.negligible_error;
    pairs_per_point_ = rules.pairs_per_point;
    squared_errors_.fill(0.0);
    classify();
    if (rules.plan == ShadowRayPlan::Everywhere) {
        trace_all_parts();
    } else {
        trace_groups();
        open_mixed_groups();
        refine_mixed_elements();
    }
    write(seen);
}

void VisibilityTracer::classify() {
    for (const std::uint32_t group : active_groups_) groups_[group] = {};
    for (const std::uint32_t block : active_blocks_) {
        const auto begin = static_cast<std::ptrdiff_t>(block * ElementBlock::kSize);
        std::fill_n(elements_.begin() + begin, ElementBlock::kSize, State{});
        std::fill_n(represented_.begin() + begin, ElementBlock::kSize, PointMask{0});
    }
    active_groups_.clear();
    active_blocks_.clear();
    shadow_rays_.clear();
    for (std::uint32_t b = 0; b < set_.blocks.size(); ++b) {
        const RelevantElements::BlockPoints relevant = relevant_.of_block(b);
        PointMask any = 0;
        for (const PointMask points : relevant) any = combine(any, points);
        if (any == 0) continue;
        for (std::size_t lane = 0; lane < relevant.size(); ++lane) {
            elements_[b * ElementBlock::kSize + lane].relevant = relevant[lane];
        }
        active_blocks_.push_back(b);
        choose_representatives(b);
    }
}

// Points for which an error of this fraction of the mass is not negligible.
PointMask VisibilityTracer::points_that_matter(const RelevantElements::Masses& masses,
                                               double fraction) const {
    PointMask points = 0;
    for (std::size_t p = 0; p < WallPointLanes::kSize; ++p) {
        const bool matters = fraction * masses.of_point[p] > negligible_error_;
        points = static_cast<PointMask>(points | std::uint32_t{matters} << p);
    }
    return points;
}

// In each group, the relevant element nearest to the middle gets the ray. Random ones disagree with
// those of neighbouring groups more often, which costs a fifth more rays.
void VisibilityTracer::choose_representatives(std::uint32_t b) {
    for (std::uint32_t g = set_.first_group[b]; g < set_.first_group[b + 1]; ++g) {
        const auto [begin, end] = elements_of(set_.groups[g]);
        PointMask left = 0;
        for (std::uint32_t element = begin; element < end; ++element) {
            left = combine(left, elements_[element].relevant);
        }
        if (left == 0) continue;
        groups_[g].relevant = left;
        active_groups_.push_back(g);
        const auto offer = [&](std::uint32_t element) {
            const PointMask points = common(left, elements_[element].relevant);
            if (points == 0) return;
            shadow_rays_.push_back({element, points, ShadowRays::drawn(0)});
            represented_[element] = points;
            left = without(left, points);
        };
        const std::uint32_t middle = begin + (end - begin) / 2;
        for (std::uint32_t element = middle; element < end && left != 0; ++element) offer(element);
        for (std::uint32_t element = middle; element > begin && left != 0; --element)
            offer(element - 1);
    }
}

void VisibilityTracer::trace_groups() {
    rays_.trace(shadow_rays_);
    // Those of a group follow one another.
    auto rays = shadow_rays_.begin();
    for (const std::uint32_t g : active_groups_) {
        const auto [begin, end] = elements_of(set_.groups[g]);
        PointMask seen = 0;
        for (; rays != shadow_rays_.end() && rays->element >= begin && rays->element < end;
             ++rays) {
            seen = combine(seen, rays->seen);
        }
        groups_[g].visible = seen;
        for (std::uint32_t element = begin; element < end; ++element) {
            elements_[element].visible = common(elements_[element].relevant, seen);
        }
    }
}

// Points for which neighbours of an item differ from it in visibility, or for which it has fewer
// than two relevant neighbours to compare with.
PointMask VisibilityTracer::mixed_points(const AdjacencyLists& lists,
                                         std::uint32_t item,
                                         const std::vector<State>& states) {
    const PointMask visible = states[item].visible;
    PointMask differ = 0;
    PointMask asked = 0;
    PointMask asked_twice = 0;
    for (const std::uint32_t neighbour : lists.of(item)) {
        const State& other = states[neighbour];
        differ = combine(differ, common(other.relevant, other.visible ^ visible));
        asked_twice = combine(asked_twice, common(asked, other.relevant));
        asked = combine(asked, other.relevant);
    }
    return without(states[item].relevant, without(asked_twice, differ));
}

void VisibilityTracer::open_mixed_groups() {
    shadow_rays_.clear();
    opened_.clear();
    for (const std::uint32_t g : active_groups_) {
        PointMask mixed = mixed_points(set_.group_neighbours, g, groups_);
        if (mixed == 0) continue;
        const auto [begin, end] = elements_of(set_.groups[g]);
        RelevantElements::Masses mass;
        for (std::uint32_t element = begin; element < end; ++element) {
            const PointMask relevant = elements_[element].relevant;
            if (relevant == 0) continue;
            const RelevantElements::Masses of_element = relevant_.masses_of(element);
            for (std::size_t p = 0; p < WallPointLanes::kSize; ++p) {
                mass.of_point[p] += (relevant >> p & 1U) != 0 ? of_element.of_point[p] : 0.0;
            }
        }
        mixed = common(mixed, points_that_matter(mass, kErrorFromOne));
        if (mixed == 0) continue;
        for (std::uint32_t element = begin; element < end; ++element) {
            const PointMask points = common(mixed, elements_[element].relevant);
            if (points == 0) continue;
            opened_.push_back({element, points});
            const PointMask unknown = without(points, represented_[element]);
            if (unknown != 0) shadow_rays_.push_back({element, unknown, ShadowRays::drawn(0)});
        }
    }
    rays_.trace(shadow_rays_);
    for (const ShadowRays& rays : shadow_rays_) {
        PointMask& visible = elements_[rays.element].visible;
        visible = combine(without(visible, rays.points), rays.seen);
    }
}

void VisibilityTracer::write(std::span<VisibleElements> seen) const {
    for (std::size_t p = 0; p < seen.size(); ++p) {
        seen[p].simd_groups.assign(set_.blocks.size(), 0);
        seen[p].masks.resize(elements_.size());
        seen[p].squared_error = squared_errors_[p];
    }
    for (const std::uint32_t block : active_blocks_) {
        const State* const elements = elements_.data() + block * ElementBlock::kSize;
        RelevantElements::BlockPoints visible;
        for (std::size_t i = 0; i < visible.size(); ++i) visible[i] = elements[i].visible;
        for (std::size_t p = 0; p < seen.size(); ++p) {
            VisibilityMask* const masks = seen[p].masks.data() + block * ElementBlock::kSize;
            for (std::size_t i = 0; i < visible.size(); ++i) {
                masks[i] = static_cast<VisibilityMask>(-(visible[i] >> p & 1));
            }
        }
        for (std::size_t u = 0; u < ElementBlock::kNumSimdGroups; ++u) {
            PointMask any = 0;
            for (std::size_t i = 0; i < ElementBlock::kSimdWidth; ++i) {
                any = combine(any, visible[u * ElementBlock::kSimdWidth + i]);
            }
            for (std::size_t p = 0; p < seen.size(); ++p) {
                seen[p].simd_groups[block] |= static_cast<SimdGroupMask>(any >> p & 1U) << u;
            }
        }
    }
    for (const auto& [element, points, masks] : refined_) {
        for_each_bit(points, [&, element = element, &masks = masks](std::size_t p) {
            seen[p].masks[element] = masks[p];
        });
    }
}

}  // namespace renderer
