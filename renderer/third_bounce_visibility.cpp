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

// Standard deviation of the visible share of a piece that a shadow's straight edge crosses, known
// from one part drawn of 16, from one drawn in each quarter, and from all 16 [found by simulation].
constexpr double kErrorFromOne = 0.34;
constexpr double kErrorFromQuarters = 0.12;
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
    const double num_exact = exact ? 1.0 : 0.0;
    std::array<bool, PieceBlock::kUnits> within;
    for (std::size_t u = 0; u < PieceBlock::kUnits; ++u) {
        const auto distance = [&](const Vec3& from) {
            const double x = block.unit_x[u] - from.x();
            const double y = block.unit_y[u] - from.y();
            const double z = block.unit_z[u] - from.z();
            return std::sqrt(x * x + y * y + z * z);
        };
        const double middle =
            distance(point_.position) + num_exact * distance(rules.other_end.position);
        const double reach = (1.0 + num_exact) * block.unit_radius_m[u];
        within[u] = (middle + reach + others.most_m >= rules.opl_begin_m) &
                    (middle - reach + others.least_m <= rules.opl_end_m);
    }
    UnitMask units = 0;
    for (std::size_t u = 0; u < within.size(); ++u) units |= UnitMask{within[u]} << u;
    return units;
}

// Pieces that show the point a side which reflects; computes their masses on the way.
std::uint64_t VisibilityTracer::lanes_seen(std::uint32_t b,
                                           UnitMask units,
                                           const WallPoint& other) {
    const PieceBlock& block = set_.blocks[b];
    const bool retro = block.kind == PieceKind::Retroreflective;
    double* const mass = piece_mass_.data() + b * kSize;
    // Terms (n_w.d) (n_x.d) / |d|^4 of both ends; a piece may reach in front of the wall point when
    // its centre does not.
    const auto term = [&](const WallPoint& point, std::size_t i, double& facing) {
        const double x = block.center_x[i] - point.position.x();
        const double y = block.center_y[i] - point.position.y();
        const double z = block.center_z[i] - point.position.z();
        const double d2 = x * x + y * y + z * z;
        const double front = x * point.normal.x() + y * point.normal.y() + z * point.normal.z();
        facing = -(x * block.normal_x[i] + y * block.normal_y[i] + z * block.normal_z[i]);
        return std::max(0.0, front + block.longest_edge_m) * std::abs(facing) / (d2 * d2);
    };
    std::uint64_t lanes = 0;
    for_each_unit(units, [&](std::size_t begin) {
        alignas(64) UnitLanes seen;
        for (std::size_t j = 0; j < seen.size(); ++j) {
            const std::size_t i = begin + j;
            double facing = 0.0;
            double other_facing = 0.0;
            const double g = term(point_, i, facing);
            const double other_g = term(other, i, other_facing);
            mass[i] = block.area_m2[i] * block.mean_reflectance[i] * g * (retro ? 1.0 : other_g);
            const bool hidden_side = block.one_sided[i] * facing < 0.0;
            seen[j] = hidden_side ? 0.0 : mass[i];
        }
        for (std::size_t j = 0; j < seen.size(); ++j) {
            lanes |= std::uint64_t{seen[j] > 0.0} << (begin + j);
        }
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
        struct Legs {
            alignas(64) UnitLanes least;
            alignas(64) UnitLanes most;
        };
        const auto find_legs = [&](const Vec3& from, Legs& legs) {
            for (std::size_t j = 0; j < PieceBlock::kUnitSize; ++j) {
                const auto squared_distance = [&](std::size_t corner) {
                    const double x = block.x[corner][begin + j] - from.x();
                    const double y = block.y[corner][begin + j] - from.y();
                    const double z = block.z[corner][begin + j] - from.z();
                    return x * x + y * y + z * z;
                };
                const double first = squared_distance(0);
                const double second = squared_distance(1);
                const double third = squared_distance(2);
                const double least2 = std::min(first, std::min(second, third)) - most_below2;
                legs.least[j] = std::sqrt(std::max(0.0, least2));
                legs.most[j] = std::sqrt(std::max(first, std::max(second, third)));
            }
        };
        Legs legs;
        find_legs(point_.position, legs);
        Legs other_legs = legs;
        if (exact && !confocal) find_legs(rules.other_end.position, other_legs);
        if (!exact) {
            other_legs.least.fill(rules.other_legs[b].least_m);
            other_legs.most.fill(rules.other_legs[b].most_m);
        }
        for (std::size_t j = 0; j < PieceBlock::kUnitSize; ++j) {
            const double least = legs.least[j] + other_legs.least[j];
            const double most = legs.most[j] + other_legs.most[j];
            const bool within = (most >= rules.opl_begin_m) & (least <= rules.opl_end_m);
            lanes |= std::uint64_t{within} << (begin + j);
        }
    });
    return lanes;
}

// In each group, the relevant piece next to the middle gets the ray: drawn ones disagree with those
// of neighbouring groups more often, and cost a fifth more rays.
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

// Every part is as likely as any other, so that shadows count by what they cover.
VisibilityTracer::FirstBits VisibilityTracer::first_bits(std::uint32_t piece) const {
    const std::uint32_t number = set_.blocks[piece / kSize].number[piece % kSize];
    const auto draw =
        static_cast<std::uint32_t>(core::Rng(0, number, point_.index).next_bits() & 0x3ffU);
    FirstBits bits{{}, draw & 3U};
    for (std::uint32_t q = 0; q < 4; ++q) bits.of_quarter[q] = 4 * q + (draw >> (2 * q + 2) & 3U);
    return bits;
}

void VisibilityTracer::trace_groups() {
    targets_.clear();
    for (const std::uint32_t g : active_groups_) {
        targets_.push_back({representative_[g], first_bits(representative_[g]).first()});
    }
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
        if (kErrorFromOne * mass <= negligible_error) continue;
        if (!is_mixed(set_.group_neighbours, group_states_, g)) continue;
        for (std::uint32_t i = base + group.begin; i < base + group.end; ++i) {
            if (piece_states_[i] == kIrrelevant) continue;
            opened_pieces_.push_back(i);
            if (i != representative_[g]) targets_.push_back({i, first_bits(i).first()});
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
        if (kErrorFromOne * piece_mass_[piece] <= negligible_error) continue;
        if (!is_mixed(set_.piece_neighbours, piece_states_, piece)) continue;
        mixed_.push_back(piece);
        const FirstBits bits = first_bits(piece);
        for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
            if (quarter == bits.first_quarter) continue;
            targets_.push_back({piece, bits.of_quarter[quarter]});
        }
    }
    shoot();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < mixed_.size(); ++i) {
        const auto quarter_of = [](std::uint32_t bit) { return 0xfU << (bit & ~3U); };
        std::uint32_t seen =
            piece_states_[mixed_[i]] == kVisible ? quarter_of(first_bits(mixed_[i]).first()) : 0;
        for (std::size_t ray = 3 * i; ray < 3 * i + 3; ++ray) {
            if (results_[ray]) seen |= quarter_of(targets_[ray].bit);
        }
        const auto mask = static_cast<VisibilityMask>(seen);
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
        const FirstBits bits = first_bits(piece);
        for (std::uint32_t bit = 0; bit < 16; ++bit) {
            if (bit != bits.of_quarter[bit / 4]) targets_.push_back({piece, bit});
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
            const auto& b = center_of_bit(target.bit);
            const auto at = [&](const std::array<PieceBlock::Lanes, 3>& corners) {
                return b[0] * corners[0][i] + b[1] * corners[1][i] + b[2] * corners[2][i];
            };
            Vec3 position(at(block.x), at(block.y), at(block.z));
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
