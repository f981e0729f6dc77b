// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/third_bounce_visibility.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace renderer {
namespace {

// Standard deviation of the visible share of an element that a shadow's straight edge crosses,
// known from one part drawn of 16, from one drawn in each quarter, and from all 16 [found by
// simulation].
constexpr double kErrorFromOne = 0.34;
constexpr double kErrorFromQuarters = 0.12;
constexpr double kErrorFromSixteenths = 0.03;

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

VisibilityMask quarter_mask(std::uint32_t quarter) {
    return static_cast<VisibilityMask>(0xfU << (4 * quarter));
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

// Points for which an error of this share of the mass is not negligible.
PointMask VisibilityTracer::points_that_matter(const RelevantElements::Masses& masses,
                                               double share) const {
    PointMask points = 0;
    for (std::size_t p = 0; p < WallPointLanes::kSize; ++p) {
        const bool matters = share * masses.of_point[p] > negligible_error_;
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

void VisibilityTracer::refine_mixed_elements() {
    shadow_rays_.clear();
    refined_.clear();
    for (const auto& [element, opened] : opened_) {
        PointMask points =
            common(opened, mixed_points(set_.element_neighbours, element, elements_));
        if (points == 0) continue;
        points = common(points, points_that_matter(relevant_.masses_of(element), kErrorFromOne));
        if (points == 0) continue;
        refined_.push_back({element, points, {}});
        for (std::uint32_t k = 1; k < 4; ++k) {
            shadow_rays_.push_back({element, points, ShadowRays::drawn(k)});
        }
    }
    rays_.trace(shadow_rays_);
    for (std::size_t i = 0; i < refined_.size(); ++i) {
        auto& [element, points, masks] = refined_[i];
        const DrawnParts parts = rays_.drawn_parts(element);
        const std::array<PointMask, 4> seen{elements_[element].visible,
                                            shadow_rays_[3 * i].seen,
                                            shadow_rays_[3 * i + 1].seen,
                                            shadow_rays_[3 * i + 2].seen};
        PointMask visible = 0;
        for_each_bit(points, [&](std::size_t p) {
            for (std::uint32_t k = 0; k < 4; ++k) {
                if ((seen[k] >> p & 1U) == 0) continue;
                masks[p] =
                    static_cast<VisibilityMask>(masks[p] | quarter_mask(parts.quarter(p, k)));
            }
            visible = static_cast<PointMask>(visible | std::uint32_t{masks[p] != 0} << p);
        });
        elements_[element].visible = combine(without(elements_[element].visible, points), visible);
    }
    refine_quarters();
}

// Traces rays to all parts of elements of which only some quarters are visible.
void VisibilityTracer::refine_quarters() {
    shadow_rays_.clear();
    std::vector<std::size_t> refined_of_rays;
    for (std::size_t i = 0; i < refined_.size(); ++i) {
        const auto& [element, refined, masks] = refined_[i];
        PointMask points = 0;
        for_each_bit(refined, [&, &masks = masks](std::size_t p) {
            const bool is_partial = masks[p] != 0 && masks[p] != kAllVisible;
            points = static_cast<PointMask>(points | std::uint32_t{is_partial} << p);
        });
        if (points == 0) continue;
        const RelevantElements::Masses mass = relevant_.masses_of(element);
        points = common(points, points_that_matter(mass, kErrorFromQuarters));
        if (points == 0) continue;
        add_squared_error(refined_[i], points);
        const DrawnParts parts = rays_.drawn_parts(element);
        for (std::uint32_t bit = 0; bit < 16; ++bit) {
            PointMask unknown = 0;
            for_each_bit(points, [&](std::size_t p) {
                const bool is_known = parts.bit(p, bit / 4) == bit;
                unknown = static_cast<PointMask>(unknown | std::uint32_t{!is_known} << p);
            });
            if (unknown == 0) continue;
            shadow_rays_.push_back({element, unknown, ShadowRays::fixed(bit)});
            refined_of_rays.push_back(i);
        }
    }
    trace_sixteenths(refined_of_rays);
}

void VisibilityTracer::add_squared_error(const Refined& refined, PointMask points) {
    const ElementKind kind = set_.blocks[refined.element / ElementBlock::kSize].kind;
    const double num_pairs = kind == ElementKind::Retroreflective ? 1.0 : pairs_per_point_;
    const RelevantElements::Masses mass = relevant_.masses_of(refined.element);
    for_each_bit(points, [&](std::size_t p) {
        squared_errors_[p] += num_pairs * std::pow(kErrorFromSixteenths * mass.of_point[p], 2);
    });
}

// Traces shadow_rays_ to single parts of refined elements and notes what they see.
void VisibilityTracer::trace_sixteenths(std::span<const std::size_t> refined_of_rays) {
    rays_.trace(shadow_rays_);
    for (std::size_t i = 0; i < shadow_rays_.size(); ++i) {
        auto& masks = refined_[refined_of_rays[i]].masks;
        const auto bit =
            static_cast<VisibilityMask>(1U << (shadow_rays_[i].part - ShadowRays::kFirstFixed));
        for_each_bit(shadow_rays_[i].points, [&](std::size_t p) {
            const bool is_seen = (shadow_rays_[i].seen >> p & 1U) != 0;
            masks[p] = static_cast<VisibilityMask>(is_seen ? masks[p] | bit : masks[p] & ~bit);
        });
    }
}

void VisibilityTracer::trace_all_parts() {
    refined_.clear();
    std::vector<std::size_t> refined_of_rays;
    std::vector<ShadowRays> singles;
    for (const std::uint32_t block : active_blocks_) {
        const auto begin = static_cast<std::uint32_t>(block * ElementBlock::kSize);
        const std::size_t num_refined = refined_.size();
        shadow_rays_.clear();
        refined_of_rays.clear();
        singles.clear();
        for (std::uint32_t element = begin; element < begin + ElementBlock::kSize; ++element) {
            const PointMask relevant = elements_[element].relevant;
            if (relevant == 0) continue;
            const PointMask points =
                common(relevant, points_that_matter(relevant_.masses_of(element), kErrorFromOne));
            const PointMask others = without(relevant, points);
            if (others != 0) singles.push_back({element, others, ShadowRays::drawn(0)});
            if (points == 0) continue;
            for (std::uint32_t bit = 0; bit < 16; ++bit) {
                shadow_rays_.push_back({element, points, ShadowRays::fixed(bit)});
                refined_of_rays.push_back(refined_.size());
            }
            refined_.push_back({element, points, {}});
        }
        trace_sixteenths(refined_of_rays);
        for (std::size_t i = num_refined; i < refined_.size(); ++i) {
            const Refined& refined = refined_[i];
            PointMask visible = 0;
            PointMask partial = 0;
            for_each_bit(refined.points, [&](std::size_t p) {
                const VisibilityMask mask = refined.masks[p];
                visible = static_cast<PointMask>(visible | std::uint32_t{mask != 0} << p);
                const bool is_partial = mask != 0 && mask != kAllVisible;
                partial = static_cast<PointMask>(partial | std::uint32_t{is_partial} << p);
            });
            elements_[refined.element].visible = visible;
            add_squared_error(refined, partial);
        }
        rays_.trace(singles);
        for (const ShadowRays& rays : singles) {
            PointMask& visible = elements_[rays.element].visible;
            visible = combine(visible, rays.seen);
        }
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
