// SPDX-License-Identifier: MIT
#include "renderer/third_bounce_visibility.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace renderer {
namespace {

using core::load;
using core::Simd;
using core::store;
using core::Vec3;

constexpr std::size_t kPoints = WallPointLanes::kSize;

// Standard deviation of the visible share of a piece that a shadow's straight edge crosses, known
// from one part drawn of 16, from one drawn in each quarter, and from all 16 [found by simulation].
constexpr double kErrorFromOne = 0.34;
constexpr double kErrorFromQuarters = 0.12;
constexpr double kErrorFromSixteenths = 0.03;

// Positions of wall points from `begin` on, relative to `origin`.
[[gnu::always_inline]] inline UnitPoints positions(const WallPointLanes& points,
                                                   std::size_t begin,
                                                   const Vec3& origin) {
    return load_points(points.x, points.y, points.z, begin, origin);
}

[[gnu::always_inline]] inline UnitPoints normals(const WallPointLanes& points, std::size_t begin) {
    return load_points(points.normal_x, points.normal_y, points.normal_z, begin, Vec3::Zero());
}

[[gnu::always_inline]] inline PointMask point_mask(const core::SimdMask& mask, std::size_t begin) {
    return static_cast<PointMask>(mask.bits() << begin);
}

PointMask combine(PointMask a, PointMask b) {
    return static_cast<PointMask>(a | b);
}

PointMask without(PointMask a, PointMask b) {
    return static_cast<PointMask>(a & ~b);
}

PointMask common(PointMask a, PointMask b) {
    return static_cast<PointMask>(a & b);
}

// Pieces [begin, end).
struct PieceRange {
    std::uint32_t begin;
    std::uint32_t end;
};

PieceRange pieces_of(const PieceGroup& group) {
    const auto begin = static_cast<std::uint32_t>(group.block * PieceBlock::kSize) +
                       static_cast<std::uint32_t>(std::countr_zero(group.lanes));
    return {begin, begin + static_cast<std::uint32_t>(std::popcount(group.lanes))};
}

VisibilityMask quarter_mask(std::uint32_t quarter) {
    return static_cast<VisibilityMask>(0xfU << (4 * quarter));
}

}  // namespace

VisibilityTracer::VisibilityTracer(const Scene& scene, const PieceSet& pieces)
    : set_(pieces),
      rays_(scene, pieces),
      groups_(pieces.groups.size()),
      pieces_(pieces.blocks.size() * PieceBlock::kSize),
      represented_(pieces_.size()) {}

void VisibilityTracer::trace(std::span<const WallPoint> points,
                             const VisibilityRules& rules,
                             std::span<VisiblePieces> seen) {
    points_ = WallPointLanes(points);
    rules_ = &rules;
    rays_.look_from(points_);
    for (std::size_t p = 0; p < kPoints; ++p) {
        const LengthBounds& opl = rules.opl_of(p < points_.count ? p : 0);
        opl_begin_m_[p] = opl.least_m;
        opl_end_m_[p] = opl.most_m;
    }
    squared_errors_.fill(0.0);
    classify();
    trace_groups();
    open_mixed_groups();
    refine_mixed_pieces();
    write(seen);
}

void VisibilityTracer::classify() {
    for (const std::uint32_t group : active_groups_) groups_[group] = {};
    for (const std::uint32_t block : active_blocks_) {
        const auto begin = static_cast<std::ptrdiff_t>(block * PieceBlock::kSize);
        std::fill_n(pieces_.begin() + begin, PieceBlock::kSize, State{});
        std::fill_n(represented_.begin() + begin, PieceBlock::kSize, PointMask{0});
    }
    active_groups_.clear();
    active_blocks_.clear();
    shadow_rays_.clear();
    for (std::uint32_t b = 0; b < set_.blocks.size(); ++b) {
        PointMask crossing = 0;
        const PointMask reaching = points_reaching(b, crossing);
        if (reaching == 0) continue;
        const BlockPoints within = points_within_axis(b, reaching, crossing);
        PointMask any = 0;
        for (std::size_t lane = 0; lane < set_.blocks[b].count; ++lane) {
            if (within[lane] == 0) continue;
            const PointMask relevant = common(within[lane], points_facing(set_.blocks[b], lane));
            pieces_[b * PieceBlock::kSize + lane].relevant = relevant;
            any = combine(any, relevant);
        }
        if (any == 0) continue;
        active_blocks_.push_back(b);
        choose_representatives(b);
    }
}

// Points from which some path by way of a block may have a length within the axis; `crossing`:
// those from which others may not.
PointMask VisibilityTracer::points_reaching(std::uint32_t b, PointMask& crossing) const {
    const auto& [center, radius] = set_.spheres[b];
    LengthBounds other;
    if (!rules_->other_legs.empty()) {
        other = rules_->other_legs[b];
    } else if (rules_->other_end) {
        const double distance = (center - rules_->other_end->position).norm();
        other = {distance - radius, distance + radius};
    }
    PointMask reaching = 0;
    crossing = 0;
    for (std::size_t begin = 0; begin < kPoints; begin += Simd::size()) {
        const UnitPoints away = positions(points_, begin, center);
        const Simd leg = core::square_root(away.dot(away));
        Simd least = leg - radius;
        Simd most = leg + radius;
        if (rules_->other_end) {
            least += other.least_m;
            most += other.most_m;
        } else {
            least += least;
            most += most;
        }
        const Simd opl_begin = load(opl_begin_m_, begin);
        const Simd opl_end = load(opl_end_m_, begin);
        const core::SimdMask in_front = away.dot(normals(points_, begin)) <= radius;
        const core::SimdMask within = in_front & (opl_begin <= most) & (least <= opl_end);
        const core::SimdMask inside = (opl_begin <= least) & (most <= opl_end);
        reaching = combine(reaching, point_mask(within, begin));
        crossing = combine(crossing, point_mask(within & !inside, begin));
    }
    crossing = common(crossing, points_.all());
    return common(reaching, points_.all());
}

// Per lane, the points from which some path by way of the piece may have a length within the axis.
VisibilityTracer::BlockPoints VisibilityTracer::points_within_axis(std::uint32_t b,
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

// Units of which some path from a point may have a length within the axis.
UnitMask VisibilityTracer::units_within_axis(std::uint32_t b, std::size_t p) const {
    static_assert(PieceBlock::kUnits == Simd::size());
    const PieceBlock& block = set_.blocks[b];
    const auto distance = [&](const Vec3& from) {
        const UnitPoints d = load_points(block.unit_x, block.unit_y, block.unit_z, 0, from);
        return core::square_root(d.dot(d));
    };
    const Simd radius = load(block.unit_radius_m, 0);
    const Simd leg = distance(points_.position(p));
    Simd least = leg - radius;
    Simd most = leg + radius;
    if (!rules_->other_legs.empty()) {
        least += rules_->other_legs[b].least_m;
        most += rules_->other_legs[b].most_m;
    } else {
        const Simd other = rules_->other_end ? distance(rules_->other_end->position) : leg;
        least += other - radius;
        most += other + radius;
    }
    const core::SimdMask within = (opl_begin_m_[p] <= most) & (least <= opl_end_m_[p]);
    return static_cast<UnitMask>(within.bits());
}

// Pieces of which some path from a point may have a length within the axis.
std::uint64_t VisibilityTracer::lanes_within_axis(std::uint32_t b, std::size_t p) const {
    const PieceBlock& block = set_.blocks[b];
    // For a point x = sum of l_c c over corners c, |x-w|^2 = sum of l_c |c-w|^2 - sum of l_c
    // |c-x|^2, and the last term is at most edge^2/3 ([Jung1901]).
    const double most_below2 = block.longest_edge_m * block.longest_edge_m / 3.0;
    struct Legs {
        Simd least, most;
    };
    std::uint64_t lanes = 0;
    for_each_unit(units_within_axis(b, p), [&](std::size_t begin) {
        const auto legs_from = [&](const Vec3& from) {
            std::array<Simd, 3> d2;
            for (std::size_t c = 0; c < 3; ++c) {
                const UnitPoints d = load_points(block.x[c], block.y[c], block.z[c], begin, from);
                d2[c] = d.dot(d);
            }
            const Simd least2 =
                core::smaller_of(core::smaller_of(d2[0], d2[1]), d2[2]) - most_below2;
            const Simd most2 = core::larger_of(core::larger_of(d2[0], d2[1]), d2[2]);
            return Legs{core::square_root(core::larger_of(least2, 0.0)), core::square_root(most2)};
        };
        const Legs legs = legs_from(points_.position(p));
        Legs others = legs;
        if (!rules_->other_legs.empty()) {
            others = {rules_->other_legs[b].least_m, rules_->other_legs[b].most_m};
        } else if (rules_->other_end) {
            others = legs_from(rules_->other_end->position);
        }
        const core::SimdMask within = (opl_begin_m_[p] <= legs.most + others.most) &
                                      (legs.least + others.least <= opl_end_m_[p]);
        lanes |= within.bits() << begin;
    });
    return lanes;
}

// Points to which a piece shows a side that reflects. It may reach in front of a wall point when
// its centre does not.
PointMask VisibilityTracer::points_facing(const PieceBlock& block, std::size_t i) const {
    if (!(block.area_m2[i] * block.mean_reflectance[i] > 0.0)) return 0;
    const Vec3 center(block.center_x[i], block.center_y[i], block.center_z[i]);
    const Vec3 normal(block.normal_x[i], block.normal_y[i], block.normal_z[i]);
    const bool has_one_end =
        rules_->other_legs.empty() && rules_->other_end && block.kind != PieceKind::Retroreflective;
    if (has_one_end) {
        const auto& [position, other_normal, index] = *rules_->other_end;
        const Vec3 away = position - center;
        if (away.dot(other_normal) >= block.longest_edge_m || away.dot(normal) == 0.0) return 0;
    }
    PointMask facing = 0;
    for (std::size_t begin = 0; begin < kPoints; begin += Simd::size()) {
        const UnitPoints away = positions(points_, begin, center);
        const Simd side = away.dot(normal);
        const core::SimdMask in_front =
            away.dot(normals(points_, begin)) < Simd(block.longest_edge_m);
        const core::SimdMask reflects = (side != 0.0) & (0.0 <= Simd(block.one_sided[i]) * side);
        facing = combine(facing, point_mask(in_front & reflects, begin));
    }
    return facing;
}

// Terms (n_w.d) (n_x.d) / |d|^4 of both legs.
VisibilityTracer::Masses VisibilityTracer::masses_of(std::uint32_t piece) const {
    const PieceBlock& block = set_.blocks[piece / PieceBlock::kSize];
    const std::size_t i = piece % PieceBlock::kSize;
    const Vec3 center(block.center_x[i], block.center_y[i], block.center_z[i]);
    const Vec3 normal(block.normal_x[i], block.normal_y[i], block.normal_z[i]);
    const double reflected = block.area_m2[i] * block.mean_reflectance[i];
    const bool looks_back = block.kind == PieceKind::Retroreflective;
    double other_term = 1.0;
    if (rules_->other_end && !looks_back) {
        const auto& [position, other_normal, index] = *rules_->other_end;
        const Vec3 away = position - center;
        const double front = block.longest_edge_m - away.dot(other_normal);
        other_term =
            std::max(0.0, front) * std::abs(away.dot(normal)) / std::pow(away.squaredNorm(), 2);
    }
    Masses masses;
    for (std::size_t begin = 0; begin < kPoints; begin += Simd::size()) {
        const UnitPoints away = positions(points_, begin, center);
        const Simd d2 = away.dot(away);
        const Simd front =
            core::larger_of(Simd(block.longest_edge_m) - away.dot(normals(points_, begin)), 0.0);
        const Simd side = away.dot(normal);
        const Simd term = front * core::larger_of(side, -side) / (d2 * d2);
        const bool confocal = !rules_->other_end && !looks_back;
        store(term * (confocal ? term : Simd(other_term)) * reflected, masses.of_point, begin);
    }
    return masses;
}

// Points to which a wrong share of what they may see is not negligible.
PointMask VisibilityTracer::points_that_matter(const Masses& masses, double share) const {
    PointMask points = 0;
    for (std::size_t p = 0; p < kPoints; ++p) {
        const bool matters = share * masses.of_point[p] > rules_->negligible_error;
        points = static_cast<PointMask>(points | std::uint32_t{matters} << p);
    }
    return points;
}

// In each group, the relevant piece next to the middle gets the ray: drawn ones disagree with those
// of neighbouring groups more often, and cost a fifth more rays.
void VisibilityTracer::choose_representatives(std::uint32_t b) {
    for (std::uint32_t g = set_.first_group[b]; g < set_.first_group[b + 1]; ++g) {
        const auto [begin, end] = pieces_of(set_.groups[g]);
        PointMask left = 0;
        for (std::uint32_t piece = begin; piece < end; ++piece) {
            left = combine(left, pieces_[piece].relevant);
        }
        if (left == 0) continue;
        groups_[g].relevant = left;
        active_groups_.push_back(g);
        const auto offer = [&](std::uint32_t piece) {
            const PointMask points = common(left, pieces_[piece].relevant);
            if (points == 0) return;
            shadow_rays_.push_back({piece, points, ShadowRays::drawn(0)});
            represented_[piece] = points;
            left = without(left, points);
        };
        const std::uint32_t middle = begin + (end - begin) / 2;
        for (std::uint32_t piece = middle; piece < end && left != 0; ++piece) offer(piece);
        for (std::uint32_t piece = middle; piece > begin && left != 0; --piece) offer(piece - 1);
    }
}

void VisibilityTracer::trace_groups() {
    rays_.trace(shadow_rays_);
    // Those of a group follow one another.
    auto rays = shadow_rays_.begin();
    for (const std::uint32_t g : active_groups_) {
        const auto [begin, end] = pieces_of(set_.groups[g]);
        PointMask seen = 0;
        for (; rays != shadow_rays_.end() && rays->piece >= begin && rays->piece < end; ++rays) {
            seen = combine(seen, rays->seen);
        }
        groups_[g].visible = seen;
        for (std::uint32_t piece = begin; piece < end; ++piece) {
            pieces_[piece].visible = common(pieces_[piece].relevant, seen);
        }
    }
}

// Points for which an item's neighbours are not of its state; without neighbours to ask, it has to
// be looked at closely.
PointMask VisibilityTracer::mixed_points(const NeighbourLists& lists,
                                         std::uint32_t item,
                                         const std::vector<State>& states) {
    const PointMask visible = states[item].visible;
    PointMask differ = 0;
    PointMask asked = 0;
    PointMask asked_twice = 0;
    for (std::uint32_t i = lists.begin[item]; i < lists.begin[item + 1]; ++i) {
        const State& other = states[lists.items[i]];
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
        const auto [begin, end] = pieces_of(set_.groups[g]);
        Masses mass;
        for (std::uint32_t piece = begin; piece < end; ++piece) {
            const PointMask relevant = pieces_[piece].relevant;
            if (relevant == 0) continue;
            const Masses of_piece = masses_of(piece);
            for (std::size_t p = 0; p < kPoints; ++p) {
                mass.of_point[p] += (relevant >> p & 1U) != 0 ? of_piece.of_point[p] : 0.0;
            }
        }
        mixed = common(mixed, points_that_matter(mass, kErrorFromOne));
        if (mixed == 0) continue;
        for (std::uint32_t piece = begin; piece < end; ++piece) {
            const PointMask points = common(mixed, pieces_[piece].relevant);
            if (points == 0) continue;
            opened_.push_back({piece, points});
            const PointMask unknown = without(points, represented_[piece]);
            if (unknown != 0) shadow_rays_.push_back({piece, unknown, ShadowRays::drawn(0)});
        }
    }
    rays_.trace(shadow_rays_);
    for (const ShadowRays& rays : shadow_rays_) {
        PointMask& visible = pieces_[rays.piece].visible;
        visible = combine(without(visible, rays.points), rays.seen);
    }
}

void VisibilityTracer::refine_mixed_pieces() {
    shadow_rays_.clear();
    refined_.clear();
    for (const auto& [piece, opened] : opened_) {
        PointMask points = common(opened, mixed_points(set_.piece_neighbours, piece, pieces_));
        if (points == 0) continue;
        points = common(points, points_that_matter(masses_of(piece), kErrorFromOne));
        if (points == 0) continue;
        refined_.push_back({piece, points, {}});
        for (std::uint32_t k = 1; k < 4; ++k) {
            shadow_rays_.push_back({piece, points, ShadowRays::drawn(k)});
        }
    }
    rays_.trace(shadow_rays_);
    for (std::size_t i = 0; i < refined_.size(); ++i) {
        auto& [piece, points, masks] = refined_[i];
        const DrawnParts parts = rays_.drawn_parts(piece);
        const std::array<PointMask, 4> seen{pieces_[piece].visible,
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
        pieces_[piece].visible = combine(without(pieces_[piece].visible, points), visible);
    }
    refine_quarters();
}

// Pieces of which only some quarters are seen get rays to all their parts.
void VisibilityTracer::refine_quarters() {
    shadow_rays_.clear();
    std::vector<std::size_t> refined_of_rays;
    for (std::size_t i = 0; i < refined_.size(); ++i) {
        const auto& [piece, refined, masks] = refined_[i];
        PointMask points = 0;
        for_each_bit(refined, [&, &masks = masks](std::size_t p) {
            const bool is_partial = masks[p] != 0 && masks[p] != kAllVisible;
            points = static_cast<PointMask>(points | std::uint32_t{is_partial} << p);
        });
        if (points == 0) continue;
        const Masses mass = masses_of(piece);
        points = common(points, points_that_matter(mass, kErrorFromQuarters));
        if (points == 0) continue;
        for_each_bit(points, [&](std::size_t p) {
            squared_errors_[p] += std::pow(kErrorFromSixteenths * mass.of_point[p], 2);
        });
        const DrawnParts parts = rays_.drawn_parts(piece);
        for (std::uint32_t bit = 0; bit < 16; ++bit) {
            PointMask unknown = 0;
            for_each_bit(points, [&](std::size_t p) {
                const bool is_known = parts.bit(p, bit / 4) == bit;
                unknown = static_cast<PointMask>(unknown | std::uint32_t{!is_known} << p);
            });
            if (unknown == 0) continue;
            shadow_rays_.push_back({piece, unknown, ShadowRays::fixed(bit)});
            refined_of_rays.push_back(i);
        }
    }
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

void VisibilityTracer::write(std::span<VisiblePieces> seen) const {
    for (std::size_t p = 0; p < points_.count; ++p) {
        seen[p].units.assign(set_.blocks.size(), 0);
        seen[p].masks.resize(pieces_.size());
        seen[p].squared_error = squared_errors_[p];
    }
    for (const std::uint32_t block : active_blocks_) {
        const State* const pieces = pieces_.data() + block * PieceBlock::kSize;
        BlockPoints visible;
        for (std::size_t i = 0; i < visible.size(); ++i) visible[i] = pieces[i].visible;
        for (std::size_t p = 0; p < points_.count; ++p) {
            VisibilityMask* const masks = seen[p].masks.data() + block * PieceBlock::kSize;
            for (std::size_t i = 0; i < visible.size(); ++i) {
                masks[i] = static_cast<VisibilityMask>(-(visible[i] >> p & 1));
            }
        }
        for (std::size_t u = 0; u < PieceBlock::kUnits; ++u) {
            PointMask any = 0;
            for (std::size_t i = 0; i < PieceBlock::kUnitSize; ++i) {
                any = combine(any, visible[u * PieceBlock::kUnitSize + i]);
            }
            for (std::size_t p = 0; p < points_.count; ++p) {
                seen[p].units[block] |= static_cast<UnitMask>(any >> p & 1U) << u;
            }
        }
    }
    for (const auto& [piece, points, masks] : refined_) {
        for_each_bit(points, [&, piece = piece, &masks = masks](std::size_t p) {
            seen[p].masks[piece] = masks[p];
        });
    }
}

}  // namespace renderer
