// SPDX-License-Identifier: MIT
// Elements that may be partly visible: rays to several parts of each.
#include "renderer/third_bounce/third_bounce_visibility.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

VisibilityMask quarter_mask(std::uint32_t quarter) {
    return static_cast<VisibilityMask>(0xfU << (4 * quarter));
}

}  // namespace

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
    const ElementBlock& block = set_.blocks[refined.element / ElementBlock::kSize];
    const double num_pairs = block.response.towards_source ? 1.0 : pairs_per_point_;
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

// Notes what the masks of a refined element say of its points.
void VisibilityTracer::note_refined(const Refined& refined) {
    PointMask visible = 0;
    PointMask partial = 0;
    for_each_bit(refined.points, [&](std::size_t p) {
        const VisibilityMask mask = refined.masks[p];
        const bool is_partial = mask != 0 && mask != kAllVisible;
        visible = static_cast<PointMask>(visible | std::uint32_t{mask != 0} << p);
        partial = static_cast<PointMask>(partial | std::uint32_t{is_partial} << p);
    });
    PointMask& all = elements_[refined.element].visible;
    all = combine(without(all, refined.points), visible);
    add_squared_error(refined, partial);
}

// Elements whose possible error is negligible get one ray each. No ray stands for neighbours, so
// that shadows of any size count by the area they cover.
void VisibilityTracer::trace_all_parts() {
    refined_.clear();
    std::vector<std::size_t> refined_of_rays;
    std::vector<ShadowRays> singles;
    for (const std::uint32_t block : active_blocks_) {
        const auto begin = static_cast<std::uint32_t>(block * ElementBlock::kSize);
        const auto first_refined = static_cast<std::ptrdiff_t>(refined_.size());
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
        rays_.trace(singles);
        for (const ShadowRays& rays : singles) elements_[rays.element].visible = rays.seen;
        trace_sixteenths(refined_of_rays);
        std::for_each(refined_.begin() + first_refined,
                      refined_.end(),
                      [&](const Refined& refined) { note_refined(refined); });
    }
}

}  // namespace renderer
