// SPDX-License-Identifier: MIT
#include "renderer/third_bounce_visibility.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::size_t kSize = PieceBlock::kSize;

// Standard deviation of the visible share of a piece at the edge of a shadow, known from its
// centre, from 4 points.
constexpr double kErrorFromCenter = 0.3;
constexpr double kErrorFromQuarters = 0.12;

}  // namespace

VisibilityTracer::VisibilityTracer(const Scene& scene, const PieceSet& pieces)
    : scene_(scene),
      set_(pieces),
      group_states_(pieces.groups.size(), kIrrelevant),
      piece_states_(pieces.blocks.size() * kSize, kIrrelevant),
      piece_mass_(pieces.blocks.size() * kSize),
      representative_(pieces.groups.size()) {}

std::uint64_t VisibilityTracer::trace(const WallPoint& point,
                                      const VisibilityRules& rules,
                                      std::vector<VisibilityMask>& masks) {
    point_ = point;
    num_rays_ = 0;
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
    return num_rays_;
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
        if (is_out_of_reach(b, rules)) continue;
        active_blocks_.push_back(b);
        classify_block(b, rules);
        choose_representatives(b);
    }
}

bool VisibilityTracer::is_out_of_reach(std::uint32_t b, const VisibilityRules& rules) const {
    const PieceBlock& block = set_.blocks[b];
    const Vec3 offset = block.sphere_center - point_.position;
    if (point_.normal.dot(offset) < -block.sphere_radius_m) return true;
    const double leg = offset.norm();
    // Pieces just outside the axis still tell their neighbours about shadows.
    const double radius = block.sphere_radius_m + block.longest_edge_m;
    LengthBounds other;
    if (rules.other_legs.empty()) {
        const double distance = (block.sphere_center - rules.other_end.position).norm();
        other = {distance - radius, distance + radius};
    } else {
        other = {rules.other_legs[b].least_m - block.longest_edge_m,
                 rules.other_legs[b].most_m + block.longest_edge_m};
    }
    return leg + radius + other.most_m < rules.opl_begin_m ||
           leg - radius + other.least_m > rules.opl_end_m;
}

// A piece is relevant when its distances overlap the interval and its lit side can be seen.
void VisibilityTracer::classify_block(std::uint32_t b, const VisibilityRules& rules) {
    const PieceBlock& block = set_.blocks[b];
    const Vec3 w = point_.position;
    const Vec3 n = point_.normal;
    const Vec3 o = rules.other_end.position;
    const Vec3 m = rules.other_end.normal;
    // Pieces just outside the axis still tell their neighbours about shadows.
    const double least = rules.opl_begin_m - 2.0 * block.longest_edge_m;
    const double most = rules.opl_end_m + 2.0 * block.longest_edge_m;
    const bool exact = rules.other_legs.empty();
    const double other_least = exact ? 0.0 : rules.other_legs[b].least_m;
    const double other_most = exact ? 0.0 : rules.other_legs[b].most_m;
    const bool retro = block.kind == PieceKind::Retroreflective;
    double* const mass = piece_mass_.data() + b * kSize;
    alignas(64) PieceBlock::Lanes relevant;
    for (std::size_t i = 0; i < kSize; ++i) {
        const double x = block.center_x[i] - w.x();
        const double y = block.center_y[i] - w.y();
        const double z = block.center_z[i] - w.z();
        const double d2 = x * x + y * y + z * z;
        const double facing =
            -(x * block.normal_x[i] + y * block.normal_y[i] + z * block.normal_z[i]);
        const double front = x * n.x() + y * n.y() + z * n.z() + block.longest_edge_m;
        const double g = std::max(0.0, front) * std::abs(facing) / (d2 * d2);
        const double ox = block.center_x[i] - o.x();
        const double oy = block.center_y[i] - o.y();
        const double oz = block.center_z[i] - o.z();
        const double o2 = ox * ox + oy * oy + oz * oz;
        const double o_facing =
            std::abs(ox * block.normal_x[i] + oy * block.normal_y[i] + oz * block.normal_z[i]);
        const double o_front = ox * m.x() + oy * m.y() + oz * m.z() + block.longest_edge_m;
        const double o_g = std::max(0.0, o_front) * o_facing / (o2 * o2);
        mass[i] = block.area_m2[i] * block.mean_reflectance[i] * g * (retro ? 1.0 : o_g);
        const double leg = std::sqrt(d2);
        const double other_leg = exact ? std::sqrt(o2) : 0.0;
        const double longest = leg + other_leg + other_most;
        const double shortest = leg + other_leg + other_least;
        const double seen = block.one_sided[i] * facing + (block.one_sided[i] == 0.0 ? 1.0 : 0.0);
        relevant[i] = longest >= least && shortest <= most && seen > 0.0 ? mass[i] : 0.0;
    }
    for (std::size_t i = 0; i < block.count; ++i) {
        piece_states_[b * kSize + i] = relevant[i] > 0.0 ? kBlocked : kIrrelevant;
    }
}

// The relevant piece nearest to the middle of each group's lanes gets its ray.
void VisibilityTracer::choose_representatives(std::uint32_t block) {
    for (std::uint32_t g = set_.first_group[block]; g < set_.first_group[block + 1]; ++g) {
        const PieceGroup& group = set_.groups[g];
        const std::uint32_t base = static_cast<std::uint32_t>(block * kSize);
        const std::uint32_t middle = (group.begin + group.end) / 2;
        std::uint32_t best = PieceBlock::kSize;
        std::uint32_t best_offset = PieceBlock::kSize;
        for (std::uint32_t lane = group.begin; lane < group.end; ++lane) {
            const std::uint32_t offset = lane < middle ? middle - lane : lane - middle;
            if (piece_states_[base + lane] == kIrrelevant || offset >= best_offset) continue;
            best = lane;
            best_offset = offset;
        }
        if (best == PieceBlock::kSize) continue;
        representative_[g] = base + best;
        group_states_[g] = kBlocked;
        active_groups_.push_back(g);
    }
}

void VisibilityTracer::trace_groups() {
    targets_.clear();
    for (const std::uint32_t g : active_groups_) targets_.push_back({representative_[g], kCenterBit});
    shoot();
    for (std::size_t i = 0; i < active_groups_.size(); ++i) {
        group_states_[active_groups_[i]] = results_[i] ? kVisible : kBlocked;
    }
}

bool VisibilityTracer::is_mixed(const NeighbourLists& lists,
                                const std::vector<State>& states,
                                std::uint32_t item) const {
    for (std::uint32_t i = lists.begin[item]; i < lists.begin[item + 1]; ++i) {
        const State other = states[lists.items[i]];
        if (other != kIrrelevant && other != states[item]) return true;
    }
    // Without neighbours to ask, the piece has to be looked at closely.
    return lists.begin[item + 1] - lists.begin[item] < 2;
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
    results_.resize(targets_.size());
    SegmentPacket packet;
    const Vec3 from = point_.position + set_.origin;
    for (std::size_t begin = 0; begin < targets_.size(); begin += SegmentPacket::kSize) {
        const std::size_t end = std::min(targets_.size(), begin + SegmentPacket::kSize);
        packet.count = 0;
        for (std::size_t t = begin; t < end; ++t) {
            const PieceBlock& block = set_.blocks[targets_[t].piece / kSize];
            const std::size_t i = targets_[t].piece % kSize;
            const auto& b = center_of_bit(targets_[t].bit);
            const Vec3 target(b[0] * block.x[0][i] + b[1] * block.x[1][i] + b[2] * block.x[2][i],
                              b[0] * block.y[0][i] + b[1] * block.y[1][i] + b[2] * block.y[2][i],
                              b[0] * block.z[0][i] + b[1] * block.z[1][i] + b[2] * block.z[2][i]);
            const Vec3 normal(block.normal_x[i], block.normal_y[i], block.normal_z[i]);
            scene_.rays().add_segment(packet, from, point_.normal, target + set_.origin, normal);
        }
        scene_.rays().trace(packet);
        for (std::size_t t = begin; t < end; ++t) {
            results_[t] = packet.blocked[t - begin] ? 0 : 1;
        }
    }
    num_rays_ += targets_.size();
}

}  // namespace renderer
