// SPDX-License-Identifier: MIT
#include "renderer/third_bounce_visibility.h"

#include "renderer/core/stopwatch.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::size_t kSize = PieceBlock::kSize;

UnitMask units_of(std::uint64_t lanes) {
    UnitMask units = 0;
    for (std::size_t u = 0; u < PieceBlock::kUnits; ++u) {
        const std::uint64_t unit = (lanes >> (u * PieceBlock::kUnitSize)) & 0xff;
        units |= UnitMask{unit != 0} << u;
    }
    return units;
}

// Squared distances from a point.
UnitArray squared_distances(const UnitArray& x,
                            const UnitArray& y,
                            const UnitArray& z,
                            const Vec3& from) {
    const UnitArray dx = x - from.x();
    const UnitArray dy = y - from.y();
    const UnitArray dz = z - from.z();
    return dx * dx + dy * dy + dz * dz;
}

// Standard deviation of the visible share of a piece that a shadow's straight edge crosses, known
// from its centre, from 4 and from 16 points [found by simulation].
constexpr double kErrorFromCenter = 0.24;
constexpr double kErrorFromQuarters = 0.083;
constexpr double kErrorFromSixteenths = 0.03;

}  // namespace

VisibilityTracer::VisibilityTracer(const Scene& scene, const PieceSet& pieces)
    : scene_(scene),
      set_(pieces),
      group_states_(pieces.groups.size(), kIrrelevant),
      piece_states_(pieces.blocks.size() * kSize, kIrrelevant),
      piece_mass_(pieces.blocks.size() * kSize),
      representative_(pieces.groups.size()) {}

VisibilityCost VisibilityTracer::trace(const WallPoint& point,
                                       const VisibilityRules& rules,
                                       std::vector<VisibilityMask>& masks) {
    point_ = point;
    cost_ = {};
    classify(rules);
    trace_groups();
    trace_pieces_of_mixed_groups(rules.negligible_error);
    masks.assign(piece_states_.size(), 0);
    for (const std::uint32_t block : active_blocks_) {
        for (std::size_t i = block * kSize; i < (block + 1) * kSize; ++i) {
            if (piece_states_[i] == kVisible) masks[i] = kAllVisible;
        }
    }
    refine_mixed_pieces(rules.negligible_error, masks);
    return cost_;
}

void VisibilityTracer::classify(const VisibilityRules& rules) {
    for (const std::uint32_t g : active_groups_) group_states_[g] = kIrrelevant;
    for (const std::uint32_t block : active_blocks_) {
        const auto begin = piece_states_.begin() + static_cast<std::ptrdiff_t>(block * kSize);
        std::fill(begin, begin + kSize, kIrrelevant);
    }
    active_groups_.clear();
    active_blocks_.clear();
    opened_pieces_.clear();
    for (std::uint32_t b = 0; b < set_.blocks.size(); ++b) {
        classify_block(b, rules);
    }
}

// Lengths of the paths from the point by way of a block to the other end, device legs left out.
LengthBounds VisibilityTracer::path_lengths(std::uint32_t b, const VisibilityRules& rules) const {
    const PieceBlock& block = set_.blocks[b];
    const double leg = (block.sphere_center - point_.position).norm();
    LengthBounds other;
    if (rules.other_legs.empty()) {
        const double distance = (block.sphere_center - rules.other_end.position).norm();
        other = {distance - block.sphere_radius_m, distance + block.sphere_radius_m};
    } else {
        other = rules.other_legs[b];
    }
    return {leg - block.sphere_radius_m + other.least_m,
            leg + block.sphere_radius_m + other.most_m};
}

void VisibilityTracer::classify_block(std::uint32_t b, const VisibilityRules& rules) {
    const PieceBlock& block = set_.blocks[b];
    if (point_.normal.dot(block.sphere_center - point_.position) < -block.sphere_radius_m) return;
    const LengthBounds lengths = path_lengths(b, rules);
    if (lengths.most_m < rules.opl_begin_m || lengths.least_m > rules.opl_end_m) return;
    const bool crosses_end =
        lengths.least_m < rules.opl_begin_m || lengths.most_m > rules.opl_end_m;
    const std::uint64_t within = crosses_end ? lanes_within_axis(b, rules) : ~std::uint64_t{0};
    const std::uint64_t relevant = within & lanes_seen(b, units_of(within), rules.other_end);
    if (relevant == 0) return;
    active_blocks_.push_back(b);
    for (std::size_t i = 0; i < block.count; ++i) {
        piece_states_[b * kSize + i] = (relevant >> i & 1U) != 0 ? kBlocked : kIrrelevant;
    }
    choose_representatives(b, relevant);
}

// Units of which some path may have a length within the axis.
UnitMask VisibilityTracer::units_within_axis(std::uint32_t b, const VisibilityRules& rules) const {
    const PieceBlock& block = set_.blocks[b];
    const bool exact = rules.other_legs.empty();
    const LengthBounds others = exact ? LengthBounds{} : rules.other_legs[b];
    static_assert(PieceBlock::kUnits == PieceBlock::kUnitSize);
    const auto distances_from = [&](const Vec3& from) {
        return square_root(
            squared_distances(load(block.unit_x), load(block.unit_y), load(block.unit_z), from));
    };
    UnitArray middle = distances_from(point_.position);
    UnitArray reach = load(block.unit_radius_m);
    if (exact) {
        middle += distances_from(rules.other_end.position);
        reach += reach;
    }
    return static_cast<UnitMask>(bits_of(middle + reach + others.most_m >= rules.opl_begin_m &&
                                         middle - reach + others.least_m <= rules.opl_end_m));
}

// Pieces that show the point a side which reflects; computes their masses on the way.
std::uint64_t VisibilityTracer::lanes_seen(std::uint32_t b,
                                           UnitMask units,
                                           const WallPoint& other) {
    const PieceBlock& block = set_.blocks[b];
    std::uint64_t lanes = 0;
    for_each_unit(units, [&](std::size_t begin) {
        const UnitArray center_x = load(block.center_x, begin);
        const UnitArray center_y = load(block.center_y, begin);
        const UnitArray center_z = load(block.center_z, begin);
        const UnitArray normal_x = load(block.normal_x, begin);
        const UnitArray normal_y = load(block.normal_y, begin);
        const UnitArray normal_z = load(block.normal_z, begin);
        // Terms (n_w.d) (n_x.d) / |d|^4 of both ends; a piece may reach in front of the wall point
        // when its centre does not.
        const auto term = [&](const WallPoint& point, UnitArray& facing) -> UnitArray {
            const UnitArray x = center_x - point.position.x();
            const UnitArray y = center_y - point.position.y();
            const UnitArray z = center_z - point.position.z();
            const UnitArray d2 = x * x + y * y + z * z;
            const UnitArray front =
                x * point.normal.x() + y * point.normal.y() + z * point.normal.z();
            facing = -(x * normal_x + y * normal_y + z * normal_z);
            return larger_of(front + block.longest_edge_m, 0.0) * larger_of(facing, -facing) /
                   (d2 * d2);
        };
        UnitArray facing;
        UnitArray other_facing;
        UnitArray mass =
            load(block.area_m2, begin) * load(block.mean_reflectance, begin) * term(point_, facing);
        if (block.kind != PieceKind::Retroreflective) mass *= term(other, other_facing);
        mass.copy_to(piece_mass_.data() + b * kSize + begin, std::experimental::element_aligned);
        const auto is_hidden = load(block.one_sided, begin) * facing < 0.0;
        lanes |= bits_of(mass > 0.0 && !is_hidden) << begin;
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
    std::uint64_t lanes = 0;
    for_each_unit(units_within_axis(b, rules), [&](std::size_t begin) {
        const auto find_legs = [&](const Vec3& from, UnitArray& least, UnitArray& most) {
            std::array<UnitArray, 3> d2;
            for (std::size_t c = 0; c < 3; ++c) {
                d2[c] = squared_distances(load(block.x[c], begin),
                                          load(block.y[c], begin),
                                          load(block.z[c], begin),
                                          from);
            }
            const UnitArray least2 = smaller_of(d2[0], smaller_of(d2[1], d2[2])) - most_below2;
            least = square_root(larger_of(least2, 0.0));
            most = square_root(larger_of(d2[0], larger_of(d2[1], d2[2])));
        };
        UnitArray least;
        UnitArray most;
        find_legs(point_.position, least, most);
        UnitArray other_least = least;
        UnitArray other_most = most;
        if (exact && !confocal) find_legs(rules.other_end.position, other_least, other_most);
        if (!exact) {
            other_least = rules.other_legs[b].least_m;
            other_most = rules.other_legs[b].most_m;
        }
        lanes |= bits_of(most + other_most >= rules.opl_begin_m &&
                         least + other_least <= rules.opl_end_m)
                 << begin;
    });
    return lanes;
}

// In each group, the relevant piece next to the middle gets the ray.
void VisibilityTracer::choose_representatives(std::uint32_t block, std::uint64_t relevant) {
    for (std::uint32_t g = set_.first_group[block]; g < set_.first_group[block + 1]; ++g) {
        const PieceGroup& group = set_.groups[g];
        const std::uint32_t count = group.end - group.begin;
        const std::uint64_t lanes = relevant >> group.begin & (~std::uint64_t{0} >> (64 - count));
        if (lanes == 0) continue;
        const std::uint64_t upper = lanes >> (count / 2);
        const int lane = upper != 0 ? static_cast<int>(count / 2) + std::countr_zero(upper)
                                    : 63 - std::countl_zero(lanes);
        representative_[g] = static_cast<std::uint32_t>(block * kSize + group.begin) +
                             static_cast<std::uint32_t>(lane);
        group_states_[g] = kBlocked;
        active_groups_.push_back(g);
    }
}

void VisibilityTracer::trace_groups() {
    targets_.clear();
    for (const std::uint32_t g : active_groups_)
        targets_.push_back({representative_[g], kCenterBit});
    shoot();
    for (std::size_t i = 0; i < active_groups_.size(); ++i) {
        group_states_[active_groups_[i]] = results_[i] ? kVisible : kBlocked;
    }
}

bool VisibilityTracer::is_mixed(const NeighbourLists& lists,
                                const std::vector<State>& states,
                                std::uint32_t item) const {
    int num_asked = 0;
    for (std::uint32_t i = lists.begin[item]; i < lists.begin[item + 1]; ++i) {
        const State other = states[lists.items[i]];
        if (other == kIrrelevant) continue;
        if (other != states[item]) return true;
        ++num_asked;
    }
    // Without neighbours to ask, the item has to be looked at closely.
    return num_asked < 2;
}

void VisibilityTracer::trace_pieces_of_mixed_groups(double negligible_error) {
    targets_.clear();
    for (const std::uint32_t g : active_groups_) {
        const PieceGroup& group = set_.groups[g];
        const auto base = static_cast<std::uint32_t>(group.block * kSize);
        double mass = 0.0;
        for (std::uint32_t i = base + group.begin; i < base + group.end; ++i) {
            if (piece_states_[i] == kIrrelevant) continue;
            mass += piece_mass_[i];
            piece_states_[i] = group_states_[g];
        }
        if (kErrorFromCenter * mass <= negligible_error) continue;
        if (!is_mixed(set_.group_neighbours, group_states_, g)) continue;
        for (std::uint32_t i = base + group.begin; i < base + group.end; ++i) {
            if (piece_states_[i] == kIrrelevant) continue;
            opened_pieces_.push_back(i);
            if (i != representative_[g]) targets_.push_back({i, kCenterBit});
        }
    }
    shoot();
    for (std::size_t i = 0; i < targets_.size(); ++i) {
        piece_states_[targets_[i].piece] = results_[i] ? kVisible : kBlocked;
    }
}

void VisibilityTracer::refine_mixed_pieces(double negligible_error,
                                           std::vector<VisibilityMask>& masks) {
    mixed_.clear();
    targets_.clear();
    for (const std::uint32_t piece : opened_pieces_) {
        if (kErrorFromCenter * piece_mass_[piece] <= negligible_error) continue;
        if (!is_mixed(set_.piece_neighbours, piece_states_, piece)) continue;
        mixed_.push_back(piece);
        for (std::uint32_t quarter = 0; quarter < 3; ++quarter) {
            targets_.push_back({piece, 4 * quarter + 3});
        }
    }
    shoot();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < mixed_.size(); ++i) {
        VisibilityMask mask = piece_states_[mixed_[i]] == kVisible ? 0xf000 : 0;
        for (std::uint32_t quarter = 0; quarter < 3; ++quarter) {
            if (results_[3 * i + quarter]) {
                mask = static_cast<VisibilityMask>(mask | (0xfU << (4 * quarter)));
            }
        }
        masks[mixed_[i]] = mask;
        if (mask == 0 || mask == kAllVisible) continue;
        if (kErrorFromQuarters * piece_mass_[mixed_[i]] <= negligible_error) continue;
        mixed_[kept++] = mixed_[i];
    }
    mixed_.resize(kept);

    targets_.clear();
    for (const std::uint32_t piece : mixed_) {
        const double error = kErrorFromSixteenths * piece_mass_[piece];
        cost_.squared_error += error * error;
        for (std::uint32_t bit = 0; bit < 16; ++bit) {
            if (bit % 4 != 3) targets_.push_back({piece, bit});
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
    const Vec3 from = point_.position + set_.origin;
    for (std::size_t begin = 0; begin < targets_.size(); begin += SegmentPacket::kSize) {
        const std::size_t count =
            std::min<std::size_t>(targets_.size() - begin, SegmentPacket::kSize);
        for (std::size_t lane = 0; lane < count; ++lane) {
            const Target& target = targets_[begin + lane];
            const PieceBlock& block = set_.blocks[target.piece / kSize];
            const std::size_t i = target.piece % kSize;
            Vec3 position(block.center_x[i], block.center_y[i], block.center_z[i]);
            if (target.bit != kCenterBit) {
                const auto& b = center_of_bit(target.bit);
                const auto at = [&](const std::array<PieceBlock::Lanes, 3>& corners) {
                    return b[0] * corners[0][i] + b[1] * corners[1][i] + b[2] * corners[2][i];
                };
                position = {at(block.x), at(block.y), at(block.z)};
            }
            const Vec3 normal(block.normal_x[i], block.normal_y[i], block.normal_z[i]);
            const double height = normal.dot(point_.position - position);
            position += std::copysign(block.rise_m[i], height) * normal;
            ends.set(lane, position + set_.origin, normal);
        }
        scene_.rays().aim(packet, from, point_.normal, ends.lanes(), static_cast<int>(count));
        scene_.rays().trace(packet);
        for (std::size_t lane = 0; lane < count; ++lane) {
            results_[begin + lane] = packet.blocked[lane] ? 0 : 1;
        }
    }
    cost_.num_rays += targets_.size();
    cost_.tracing_seconds += watch.seconds();
}

}  // namespace renderer
