// SPDX-License-Identifier: MIT
#include "renderer/third_bounce_visibility.h"

#include "renderer/core/random.h"
#include "renderer/core/stopwatch.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

using core::load;
using core::Simd;
using core::store;
using core::Vec3;

UnitMask units_of(std::uint64_t lanes) {
    UnitMask units = 0;
    for (std::size_t u = 0; u < PieceBlock::kUnits; ++u) {
        const std::uint64_t unit = (lanes >> (u * PieceBlock::kUnitSize)) & 0xff;
        units |= UnitMask{unit != 0} << u;
    }
    return units;
}

// Standard deviation of the visible share of a piece that a shadow's straight edge crosses, known
// from one part drawn of 16, from one drawn in each quarter, and from all 16 [found by simulation].
constexpr double kErrorFromOne = 0.34;
constexpr double kErrorFromQuarters = 0.12;
constexpr double kErrorFromSixteenths = 0.03;

// Moves points on triangles by `rise_m` to the side that `from` looks at, then by `origin`.
void lift(SegmentEnds& ends,
          const SegmentEnds::Lanes& rise_m,
          const Vec3& from,
          const Vec3& origin) {
    for (std::size_t begin = 0; begin < rise_m.size(); begin += Simd::size()) {
        const UnitPoints point = load_points(ends.x, ends.y, ends.z, begin, from);
        const UnitPoints normal =
            load_points(ends.normal_x, ends.normal_y, ends.normal_z, begin, Vec3::Zero());
        const Simd rise = load(rise_m, begin);
        const Simd moved = core::select(0.0 < point.dot(normal), -rise, rise);
        store(load(ends.x, begin) + moved * normal.x + origin.x(), ends.x, begin);
        store(load(ends.y, begin) + moved * normal.y + origin.y(), ends.y, begin);
        store(load(ends.z, begin) + moved * normal.z + origin.z(), ends.z, begin);
    }
}

}  // namespace

VisibilityTracer::VisibilityTracer(const Scene& scene, const PieceSet& pieces)
    : scene_(scene),
      set_(pieces),
      group_states_(pieces.groups.size(), kIrrelevant),
      lanes_(pieces.blocks.size()),
      masses_(std::make_unique_for_overwrite<BlockMasses[]>(pieces.blocks.size())) {}

VisibilityCost VisibilityTracer::trace(const WallPoint& point,
                                       const VisibilityRules& rules,
                                       VisiblePieces& seen) {
    point_ = point;
    cost_ = {};
    classify(rules);
    trace_groups();
    trace_pieces_of_mixed_groups(rules.negligible_error);
    seen.masks.resize(set_.blocks.size() * PieceBlock::kSize);
    for (const std::uint32_t block : active_blocks_) {
        const std::uint64_t visible = lanes_[block].visible;
        VisibilityMask* const of_block = seen.masks.data() + block * PieceBlock::kSize;
        for (std::size_t i = 0; i < PieceBlock::kSize; ++i) {
            of_block[i] = (visible >> i & 1U) != 0 ? kAllVisible : VisibilityMask{0};
        }
    }
    refine_mixed_pieces(rules.negligible_error, seen.masks);
    seen.units.assign(set_.blocks.size(), 0);
    for (const std::uint32_t block : active_blocks_) {
        seen.units[block] = units_of(lanes_[block].visible);
    }
    return cost_;
}

void VisibilityTracer::classify(const VisibilityRules& rules) {
    for (const ActiveGroup& active : active_groups_) group_states_[active.group] = kIrrelevant;
    for (const std::uint32_t block : active_blocks_) lanes_[block] = {};
    active_groups_.clear();
    active_blocks_.clear();
    opened_pieces_.clear();
    for (std::uint32_t b = 0; b < set_.blocks.size(); ++b) {
        classify_block(b, rules);
    }
}

// Lengths of the paths from the point by way of a block to the other end, device legs left out.
LengthBounds VisibilityTracer::path_lengths(std::uint32_t b, const VisibilityRules& rules) const {
    const auto& [center, radius] = set_.spheres[b];
    const double leg = (center - point_.position).norm();
    LengthBounds other;
    if (rules.other_legs.empty()) {
        const double distance = (center - rules.other_end.position).norm();
        other = {distance - radius, distance + radius};
    } else {
        other = rules.other_legs[b];
    }
    return {leg - radius + other.least_m, leg + radius + other.most_m};
}

void VisibilityTracer::classify_block(std::uint32_t b, const VisibilityRules& rules) {
    const BlockSphere& sphere = set_.spheres[b];
    if (point_.normal.dot(sphere.center - point_.position) < -sphere.radius_m) return;
    const LengthBounds lengths = path_lengths(b, rules);
    if (lengths.most_m < rules.opl_begin_m || lengths.least_m > rules.opl_end_m) return;
    const bool crosses_end =
        lengths.least_m < rules.opl_begin_m || lengths.most_m > rules.opl_end_m;
    const std::uint64_t within = crosses_end ? lanes_within_axis(b, rules) : ~std::uint64_t{0};
    const std::uint64_t relevant = within & lanes_seen(b, units_of(within), rules.other_end);
    if (relevant == 0) return;
    active_blocks_.push_back(b);
    lanes_[b] = {relevant, 0};
    choose_representatives(b);
}

// Units of which some path may have a length within the axis.
UnitMask VisibilityTracer::units_within_axis(std::uint32_t b, const VisibilityRules& rules) const {
    static_assert(PieceBlock::kUnits == Simd::size());
    const PieceBlock& block = set_.blocks[b];
    const auto distance = [&](const Vec3& from) {
        const UnitPoints d = load_points(block.unit_x, block.unit_y, block.unit_z, 0, from);
        return core::square_root(d.dot(d));
    };
    const Simd radius = load(block.unit_radius_m, 0);
    const Simd leg = distance(point_.position);
    Simd least = leg - radius;
    Simd most = leg + radius;
    if (rules.other_legs.empty()) {
        const Simd other =
            rules.other_end.position == point_.position ? leg : distance(rules.other_end.position);
        least += other - radius;
        most += other + radius;
    } else {
        least += rules.other_legs[b].least_m;
        most += rules.other_legs[b].most_m;
    }
    return static_cast<UnitMask>(((rules.opl_begin_m <= most) & (least <= rules.opl_end_m)).bits());
}

// Pieces that show the point a side which reflects; computes their masses on the way.
std::uint64_t VisibilityTracer::lanes_seen(std::uint32_t b,
                                           UnitMask units,
                                           const WallPoint& other) {
    const PieceBlock& block = set_.blocks[b];
    const bool looks_twice =
        block.kind != PieceKind::Retroreflective && other.position != point_.position;
    std::uint64_t lanes = 0;
    for_each_unit(units, [&](std::size_t begin) {
        const UnitPoints normal =
            load_points(block.normal_x, block.normal_y, block.normal_z, begin, Vec3::Zero());
        // Term (n_w.d) (n_x.d) / |d|^4; a piece may reach in front of the wall point when its
        // centre does not.
        const auto look_from = [&](const WallPoint& from, Simd& facing) {
            const UnitPoints d =
                load_points(block.center_x, block.center_y, block.center_z, begin, from.position);
            const Simd d2 = d.dot(d);
            const Simd front = core::larger_of(d.dot(from.normal) + block.longest_edge_m, 0.0);
            facing = -d.dot(normal);
            return Simd(front * core::larger_of(facing, -facing) / (d2 * d2));
        };
        Simd facing;
        const Simd term = look_from(point_, facing);
        Simd other_term = block.kind == PieceKind::Retroreflective ? Simd(1.0) : term;
        if (looks_twice) {
            Simd other_facing;
            other_term = look_from(other, other_facing);
        }
        const Simd unit_mass =
            load(block.area_m2, begin) * load(block.mean_reflectance, begin) * term * other_term;
        store(unit_mass, masses_[b].of_lane, begin);
        const core::SimdMask seen =
            (0.0 < unit_mass) & !(load(block.one_sided, begin) * facing < 0.0);
        lanes |= seen.bits() << begin;
    });
    return lanes;
}

// Pieces of which some path may have a length within the axis.
std::uint64_t VisibilityTracer::lanes_within_axis(std::uint32_t b,
                                                  const VisibilityRules& rules) const {
    const PieceBlock& block = set_.blocks[b];
    const bool exact = rules.other_legs.empty();
    const bool confocal = exact && rules.other_end.position == point_.position;
    // For a point x = sum of l_c c over corners c, |x-w|^2 = sum of l_c |c-w|^2 - sum of l_c
    // |c-x|^2, and the last term is at most edge^2/3 ([Jung1901]).
    const double most_below2 = block.longest_edge_m * block.longest_edge_m / 3.0;
    struct Legs {
        Simd least, most;
    };
    std::uint64_t lanes = 0;
    for_each_unit(units_within_axis(b, rules), [&](std::size_t begin) {
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
        const Legs legs = legs_from(point_.position);
        Legs others = legs;
        if (!exact) {
            others = {rules.other_legs[b].least_m, rules.other_legs[b].most_m};
        } else if (!confocal) {
            others = legs_from(rules.other_end.position);
        }
        const core::SimdMask within = (rules.opl_begin_m <= legs.most + others.most) &
                                      (legs.least + others.least <= rules.opl_end_m);
        lanes |= within.bits() << begin;
    });
    return lanes;
}

// Every part is as likely as any other, so that shadows count by what they cover.
inline VisibilityTracer::FirstBits VisibilityTracer::first_bits(std::uint32_t piece) const {
    const std::uint32_t number =
        set_.blocks[piece / PieceBlock::kSize].number[piece % PieceBlock::kSize];
    return {static_cast<std::uint32_t>(core::Rng(0, number, point_.index).next_bits())};
}

// In each group, the relevant piece next to the middle gets the ray: drawn ones disagree with those
// of neighbouring groups more often, and cost a fifth more rays.
void VisibilityTracer::choose_representatives(std::uint32_t b) {
    const std::uint64_t relevant = lanes_[b].relevant;
    for (std::uint32_t g = set_.first_group[b]; g < set_.first_group[b + 1]; ++g) {
        const PieceGroup& group = set_.groups[g];
        const std::uint64_t lanes = relevant & group.lanes;
        if (lanes == 0) continue;
        const int middle = std::countr_zero(group.lanes) + std::popcount(group.lanes) / 2;
        const std::uint64_t upper = lanes >> middle;
        const int lane =
            upper != 0 ? middle + std::countr_zero(upper) : 63 - std::countl_zero(lanes);
        group_states_[g] = kBlocked;
        active_groups_.push_back(
            {g,
             static_cast<std::uint32_t>(b * PieceBlock::kSize) + static_cast<std::uint32_t>(lane)});
    }
}

void VisibilityTracer::trace_groups() {
    targets_.clear();
    for (const ActiveGroup& active : active_groups_) {
        const std::uint32_t piece = active.representative;
        targets_.push_back({piece, first_bits(piece).first()});
    }
    shoot();
    for (std::size_t i = 0; i < active_groups_.size(); ++i) {
        if (!results_[i]) continue;
        const std::uint32_t g = active_groups_[i].group;
        group_states_[g] = kVisible;
        BlockLanes& lanes = lanes_[set_.groups[g].block];
        lanes.visible |= lanes.relevant & set_.groups[g].lanes;
    }
}

VisibilityTracer::State VisibilityTracer::state_of(std::uint32_t piece) const {
    const BlockLanes& lanes = lanes_[piece / PieceBlock::kSize];
    const std::uint32_t lane = piece % PieceBlock::kSize;
    if ((lanes.relevant >> lane & 1U) == 0) return kIrrelevant;
    return (lanes.visible >> lane & 1U) != 0 ? kVisible : kBlocked;
}

void VisibilityTracer::set_visible(std::uint32_t piece, bool is_visible) {
    std::uint64_t& visible = lanes_[piece / PieceBlock::kSize].visible;
    const std::uint64_t bit = std::uint64_t{1} << (piece % PieceBlock::kSize);
    visible = is_visible ? visible | bit : visible & ~bit;
}

template <class StateOf>
bool VisibilityTracer::is_mixed(const NeighbourLists& lists,
                                std::uint32_t item,
                                const StateOf& state_of_item) {
    const State own = state_of_item(item);
    int num_asked = 0;
    for (std::uint32_t i = lists.begin[item]; i < lists.begin[item + 1]; ++i) {
        const State other = state_of_item(lists.items[i]);
        if (other == kIrrelevant) continue;
        if (other != own) return true;
        ++num_asked;
    }
    // Without neighbours to ask, the item has to be looked at closely.
    return num_asked < 2;
}

void VisibilityTracer::trace_pieces_of_mixed_groups(double negligible_error) {
    targets_.clear();
    for (const auto& [g, representative] : active_groups_) {
        const auto state_of_group = [&](std::uint32_t other) { return group_states_[other]; };
        if (!is_mixed(set_.group_neighbours, g, state_of_group)) continue;
        const PieceGroup& group = set_.groups[g];
        const auto base = static_cast<std::uint32_t>(group.block * PieceBlock::kSize);
        const std::uint64_t relevant = lanes_[group.block].relevant & group.lanes;
        double mass = 0.0;
        for_each_bit(relevant,
                     [&](std::size_t lane) { mass += masses_[group.block].of_lane[lane]; });
        if (kErrorFromOne * mass <= negligible_error) continue;
        for_each_bit(relevant, [&](std::size_t lane) {
            const auto piece = static_cast<std::uint32_t>(base + lane);
            opened_pieces_.push_back(piece);
            if (piece == representative) return;
            targets_.push_back({piece, first_bits(piece).first()});
        });
    }
    shoot();
    for (std::size_t i = 0; i < targets_.size(); ++i) {
        set_visible(targets_[i].piece, results_[i] != 0);
    }
}

void VisibilityTracer::refine_mixed_pieces(double negligible_error,
                                           std::vector<VisibilityMask>& masks) {
    mixed_.clear();
    targets_.clear();
    const auto state_of_piece = [&](std::uint32_t piece) { return state_of(piece); };
    for (const std::uint32_t piece : opened_pieces_) {
        if (kErrorFromOne * mass_of(piece) <= negligible_error) continue;
        if (!is_mixed(set_.piece_neighbours, piece, state_of_piece)) continue;
        mixed_.push_back(piece);
        const FirstBits bits = first_bits(piece);
        for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
            if (quarter == bits.first_quarter()) continue;
            targets_.push_back({piece, bits.of_quarter(quarter)});
        }
    }
    shoot();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < mixed_.size(); ++i) {
        const auto quarter_of = [](std::uint32_t bit) { return 0xfU << (bit & ~3U); };
        std::uint32_t seen =
            state_of(mixed_[i]) == kVisible ? quarter_of(first_bits(mixed_[i]).first()) : 0;
        for (std::size_t ray = 3 * i; ray < 3 * i + 3; ++ray) {
            if (results_[ray]) seen |= quarter_of(targets_[ray].bit);
        }
        const auto mask = static_cast<VisibilityMask>(seen);
        masks[mixed_[i]] = mask;
        set_visible(mixed_[i], mask != 0);
        if (mask == 0 || mask == kAllVisible) continue;
        if (kErrorFromQuarters * mass_of(mixed_[i]) <= negligible_error) continue;
        mixed_[kept++] = mixed_[i];
    }
    mixed_.resize(kept);

    targets_.clear();
    for (const std::uint32_t piece : mixed_) {
        const double error = kErrorFromSixteenths * mass_of(piece);
        cost_.squared_error += error * error;
        const FirstBits bits = first_bits(piece);
        for (std::uint32_t bit = 0; bit < 16; ++bit) {
            if (bit != bits.of_quarter(bit / 4)) targets_.push_back({piece, bit});
        }
    }
    shoot();
    for (std::size_t i = 0; i < targets_.size(); ++i) {
        VisibilityMask& mask = masks[targets_[i].piece];
        const auto bit = static_cast<VisibilityMask>(1U << targets_[i].bit);
        mask = static_cast<VisibilityMask>(results_[i] ? mask | bit : mask & ~bit);
    }
}

void VisibilityTracer::shoot() {
    const core::Stopwatch watch;
    results_.resize(targets_.size());
    SegmentPacket packet;
    SegmentEnds ends;
    alignas(64) SegmentEnds::Lanes rise_m{};
    const auto& centers = centers_of_bits();
    for (std::size_t begin = 0; begin < targets_.size(); begin += SegmentPacket::kSize) {
        const std::size_t count =
            std::min<std::size_t>(targets_.size() - begin, SegmentPacket::kSize);
        for (std::size_t lane = 0; lane < count; ++lane) {
            const Target& target = targets_[begin + lane];
            const PieceBlock& block = set_.blocks[target.piece / PieceBlock::kSize];
            const std::size_t i = target.piece % PieceBlock::kSize;
            const auto& b = centers[target.bit];
            const auto at = [&](const std::array<PieceBlock::Lanes, 3>& corners) {
                return b[0] * corners[0][i] + b[1] * corners[1][i] + b[2] * corners[2][i];
            };
            ends.x[lane] = at(block.x);
            ends.y[lane] = at(block.y);
            ends.z[lane] = at(block.z);
            ends.normal_x[lane] = block.normal_x[i];
            ends.normal_y[lane] = block.normal_y[i];
            ends.normal_z[lane] = block.normal_z[i];
            rise_m[lane] = block.rise_m[i];
        }
        lift(ends, rise_m, point_.position, set_.origin);
        scene_.rays().aim(packet,
                          point_.position + set_.origin,
                          point_.normal,
                          ends.lanes(),
                          static_cast<int>(count));
        scene_.rays().trace(packet);
        for (std::size_t lane = 0; lane < count; ++lane) {
            results_[begin + lane] = packet.blocked[lane] ? 0 : 1;
        }
    }
    cost_.num_rays += targets_.size();
    cost_.tracing_seconds += watch.seconds();
}

}  // namespace renderer
