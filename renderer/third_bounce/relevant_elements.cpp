// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/relevant_elements.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::load;
using core::Simd;
using core::store;
using core::Vec3;

[[gnu::always_inline]] inline PointMask point_mask(const core::SimdMask& mask, std::size_t begin) {
    return static_cast<PointMask>(mask.bits() << begin);
}

}  // namespace

void RelevantElements::look_from(const WallPointLanes& points, const VisibilityRules& rules) {
    points_ = points;
    rules_ = &rules;
    for (std::size_t p = 0; p < WallPointLanes::kSize; ++p) {
        const LengthBounds& opl = rules.opl_of(p < points_.count ? p : 0);
        opl_begin_m_[p] = opl.min_m;
        opl_end_m_[p] = opl.max_m;
    }
}

RelevantElements::BlockPoints RelevantElements::of_block(std::uint32_t b) const {
    const ElementBlock& block = set_.blocks[b];
    PointMask crossing = 0;
    PointMask reaching = points_reaching(b, crossing);
    if (block.response.towards_source) {
        reaching = common(reaching, points_.confocal);
        crossing = common(crossing, points_.confocal);
    }
    if (reaching == 0) return {};
    BlockPoints relevant = points_within_axis(b, reaching, crossing);
    for (std::size_t lane = 0; lane < relevant.size(); ++lane) {
        if (relevant[lane] == 0) continue;
        relevant[lane] = common(relevant[lane], points_facing(block, lane));
    }
    return relevant;
}

// Points from which some path by way of a block may have a length within the axis; `crossing`:
// those of them from which other paths may not.
PointMask RelevantElements::points_reaching(std::uint32_t b, PointMask& crossing) const {
    const auto& [center, radius] = set_.spheres[b];
    LengthBounds other;
    if (!rules_->other_segments.empty()) {
        other = rules_->other_segments[b];
    } else if (rules_->other_end) {
        const double distance = (center - rules_->other_end->position).norm();
        other = {distance - radius, distance + radius};
    }
    PointMask reaching = 0;
    crossing = 0;
    for (std::size_t begin = 0; begin < WallPointLanes::kSize; begin += Simd::size()) {
        const SimdVec3 away = points_.position.load(begin, center);
        const Simd segment = core::sqrt(away.dot(away));
        Simd least = segment - radius;
        Simd most = segment + radius;
        if (rules_->other_end) {
            least += other.min_m;
            most += other.max_m;
        } else {
            least += least;
            most += most;
        }
        const Simd opl_begin = load(opl_begin_m_, begin);
        const Simd opl_end = load(opl_end_m_, begin);
        const core::SimdMask in_front = away.dot(points_.normal.load(begin)) <= radius;
        const core::SimdMask within = in_front & (opl_begin <= most) & (least <= opl_end);
        const core::SimdMask inside = (opl_begin <= least) & (most <= opl_end);
        reaching = combine(reaching, point_mask(within, begin));
        crossing = combine(crossing, point_mask(within & !inside, begin));
    }
    crossing = common(crossing, points_.all());
    return common(reaching, points_.all());
}

// Per lane, the points from which some path by way of the element may have a length within the
// axis.
RelevantElements::BlockPoints RelevantElements::points_within_axis(std::uint32_t b,
                                                                   PointMask reaching,
                                                                   PointMask crossing) const {
    BlockPoints within;
    within.fill(without(reaching, crossing));
    for_each_bit(crossing, [&](std::size_t p) {
        for_each_bit(lanes_within_axis(b, p), [&](std::size_t lane) {
            within[lane] = static_cast<PointMask>(within[lane] | 1U << p);
        });
    });
    return within;
}

// SIMD groups by way of which some path from a point may have a length within the axis.
SimdGroupMask RelevantElements::simd_groups_within_axis(std::uint32_t b, std::size_t p) const {
    static_assert(ElementBlock::kNumSimdGroups == Simd::size());
    const ElementBlock& block = set_.blocks[b];
    const auto distance = [&](const Vec3& from) {
        const SimdVec3 d = block.simd_group_center.load(0, from);
        return core::sqrt(d.dot(d));
    };
    const Simd radius = load(block.simd_group_radius_m, 0);
    const Simd segment = distance(points_.position[p]);
    Simd least = segment - radius;
    Simd most = segment + radius;
    if (!rules_->other_segments.empty()) {
        least += rules_->other_segments[b].min_m;
        most += rules_->other_segments[b].max_m;
    } else {
        const Simd other = rules_->other_end ? distance(rules_->other_end->position) : segment;
        least += other - radius;
        most += other + radius;
    }
    const core::SimdMask within = (opl_begin_m_[p] <= most) & (least <= opl_end_m_[p]);
    return static_cast<SimdGroupMask>(within.bits());
}

// Elements by way of which some path from a point may have a length within the axis.
std::uint64_t RelevantElements::lanes_within_axis(std::uint32_t b, std::size_t p) const {
    const ElementBlock& block = set_.blocks[b];
    // For a point x = sum of l_c c over corners c, |x-w|^2 = sum of l_c |c-w|^2 - sum of l_c
    // |c-x|^2, and the last term is at most edge^2/3 ([Jung1901]).
    const double most_below2 = block.longest_edge_m * block.longest_edge_m / 3.0;
    struct Segments {
        Simd least, most;
    };
    std::uint64_t lanes = 0;
    for_each_simd_group(simd_groups_within_axis(b, p), [&](std::size_t begin) {
        const auto segments_from = [&](const Vec3& from) {
            std::array<Simd, 3> d2;
            for (std::size_t c = 0; c < 3; ++c) {
                const SimdVec3 d = block.corners[c].load(begin, from);
                d2[c] = d.dot(d);
            }
            const Simd least2 = core::min(core::min(d2[0], d2[1]), d2[2]) - most_below2;
            const Simd most2 = core::max(core::max(d2[0], d2[1]), d2[2]);
            return Segments{core::sqrt(core::max(least2, 0.0)), core::sqrt(most2)};
        };
        const Segments segments = segments_from(points_.position[p]);
        Segments others = segments;
        if (!rules_->other_segments.empty()) {
            others = {rules_->other_segments[b].min_m, rules_->other_segments[b].max_m};
        } else if (rules_->other_end) {
            others = segments_from(rules_->other_end->position);
        }
        const core::SimdMask within = (opl_begin_m_[p] <= segments.most + others.most) &
                                      (segments.least + others.least <= opl_end_m_[p]);
        lanes |= within.bits() << begin;
    });
    return lanes;
}

// Points that an element faces with a reflecting side. It may reach in front of a wall point when
// its centre does not.
PointMask RelevantElements::points_facing(const ElementBlock& block, std::size_t i) const {
    if (!(block.area_m2[i] * block.mean_reflectance[i] > 0.0)) return 0;
    const Vec3 center = block.center[i];
    const Vec3 normal = block.normal[i];
    const bool has_one_end =
        rules_->other_segments.empty() && rules_->other_end && !block.response.towards_source;
    if (has_one_end) {
        const Vec3& other_normal = rules_->other_end->normal;
        const Vec3 away = rules_->other_end->position - center;
        if (away.dot(other_normal) >= block.longest_edge_m || away.dot(normal) == 0.0) return 0;
    }
    PointMask facing = 0;
    for (std::size_t begin = 0; begin < WallPointLanes::kSize; begin += Simd::size()) {
        const SimdVec3 away = points_.position.load(begin, center);
        const Simd side = away.dot(normal);
        const core::SimdMask in_front =
            away.dot(points_.normal.load(begin)) < Simd(block.longest_edge_m);
        const core::SimdMask reflects = (side != 0.0) & (0.0 <= Simd(block.one_sided[i]) * side);
        facing = combine(facing, point_mask(in_front & reflects, begin));
    }
    return facing;
}

// Terms (n_w.d) (n_x.d) / |d|^4 of both segments.
RelevantElements::Masses RelevantElements::masses_of(std::uint32_t element) const {
    const ElementBlock& block = set_.blocks[element / ElementBlock::kSize];
    const std::size_t i = element % ElementBlock::kSize;
    const Vec3 center = block.center[i];
    const Vec3 normal = block.normal[i];
    const double reflected = block.area_m2[i] * block.mean_reflectance[i];
    const bool looks_back = block.response.towards_source;
    double other_term = 1.0;
    if (rules_->other_end && !looks_back) {
        const Vec3& other_normal = rules_->other_end->normal;
        const Vec3 away = rules_->other_end->position - center;
        const double front = block.longest_edge_m - away.dot(other_normal);
        other_term =
            std::max(0.0, front) * std::abs(away.dot(normal)) / std::pow(away.squaredNorm(), 2);
    }
    const bool confocal = !rules_->other_end && !looks_back;
    Masses masses;
    for (std::size_t begin = 0; begin < WallPointLanes::kSize; begin += Simd::size()) {
        const SimdVec3 away = points_.position.load(begin, center);
        const Simd d2 = away.dot(away);
        const Simd front =
            core::max(Simd(block.longest_edge_m) - away.dot(points_.normal.load(begin)), 0.0);
        const Simd side = away.dot(normal);
        const Simd term = front * core::max(side, -side) / (d2 * d2);
        store(term * (confocal ? term : Simd(other_term)) * reflected, masses.of_point, begin);
    }
    return masses;
}

}  // namespace renderer
