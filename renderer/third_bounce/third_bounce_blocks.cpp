// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/third_bounce_blocks.h"

#include "renderer/core/random.h"
#include "renderer/geometry/median_split.h"
#include "renderer/third_bounce/piece_neighbours.h"
#include "renderer/third_bounce/piece_units.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <variant>

namespace renderer {
namespace {

using core::Vec3;

// A group spans at most this times sqrt(tolerance) times its distance, ...
constexpr double kGroupSizePerDistance = 0.8;
// ... and its normals differ by about 30 degrees at most.
constexpr double kLeastGroupCosine = 0.85;

double reflectance(const Bsdf& bsdf, PieceKind kind, double laser_spot_m2) {
    const double albedo = albedo_of(bsdf);
    return kind == PieceKind::Retroreflective ? albedo / laser_spot_m2 : albedo / core::kPi;
}

struct PieceCenter {
    Vec3 position;
    std::size_t piece;
};

// Median splits along the longest side of the centres' box, at whole blocks where there are
// several.
void sort_into_blocks(std::span<PieceCenter> centers) {
    const std::size_t count = centers.size();
    if (count < 2) return;
    Eigen::AlignedBox3d box;
    for (const PieceCenter& center : centers) box.extend(center.position);
    std::size_t half = (count + 1) / 2;
    if (count > PieceBlock::kSize)
        half = (half + PieceBlock::kSize - 1) / PieceBlock::kSize * PieceBlock::kSize;
    split_along_longest_side(
        centers, half, box, [](const PieceCenter& c) -> const Vec3& { return c.position; });
    sort_into_blocks(centers.first(half));
    sort_into_blocks(centers.subspan(half));
}

void find_unit_spheres(PieceBlock& block) {
    for_each_unit(kAllUnits, [&](std::size_t begin) {
        Eigen::AlignedBox3d box;
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = begin; i < begin + PieceBlock::kUnitSize; ++i) {
                box.extend(Vec3(block.x[c][i], block.y[c][i], block.z[c][i]));
            }
        }
        const std::size_t unit = begin / PieceBlock::kUnitSize;
        block.unit_x[unit] = box.center().x();
        block.unit_y[unit] = box.center().y();
        block.unit_z[unit] = box.center().z();
        block.unit_radius_m[unit] = 0.5 * box.diagonal().norm();
    });
}

}  // namespace

PieceArranger::PieceArranger(const Scene& scene,
                             const core::Scan& scan,
                             const PieceRules& rules,
                             std::vector<int> visible_side)
    : scene_(scene), rules_(rules), visible_side_(std::move(visible_side)) {
    set_.origin = scene.rays().origin();
    Vec3 sum = Vec3::Zero();
    for (const Vec3& point : scan.sensing.positions) sum += point - set_.origin;
    scan_center_ = sum / static_cast<double>(scan.sensing.size());
}

void PieceArranger::fill_lane(PieceBlock& block,
                              std::size_t lane,
                              const MergedPiece& merged) const {
    const Piece& piece = merged.triangle;
    for (std::size_t i = 0; i < 3; ++i) {
        block.x[i][lane] = piece.corners[i].x();
        block.y[i][lane] = piece.corners[i].y();
        block.z[i][lane] = piece.corners[i].z();
        block.squared_edge[i][lane] =
            (piece.corners[(i + 2) % 3] - piece.corners[(i + 1) % 3]).squaredNorm();
    }
    block.normal_x[lane] = merged.normal.x();
    block.normal_y[lane] = merged.normal.y();
    block.normal_z[lane] = merged.normal.z();
    const Vec3 center = piece.center();
    block.center_x[lane] = center.x();
    block.center_y[lane] = center.y();
    block.center_z[lane] = center.z();
    block.area_m2[lane] = merged.area_m2;
    block.rise_m[lane] = merged.rise_m;
    block.one_sided[lane] = visible_side_[scene_.facet(piece.facet).object];
    block.facet[lane] = piece.facet;
    block.random_bits[lane] =
        static_cast<std::uint32_t>(core::Rng(0, piece.number, /*sample=*/1).next_bits());
    block.mean_reflectance[lane] = 0.0;
    for (std::size_t node = 0; node < PieceBlock::kNodes; ++node) {
        const Vec3 position = node < 3   ? piece.corners[node]
                              : node < 6 ? piece.midpoint(node - 3)
                                         : center;
        const double share = node < 3 ? kShareOfCorner : node < 6 ? kShareOfMiddle : kShareOfCenter;
        const Bsdf bsdf = scene_.bsdf_at({position + set_.origin, piece.facet});
        block.reflectance[node][lane] = reflectance(bsdf, block.kind, rules_.laser_spot_m2);
        block.mean_reflectance[lane] += share * block.reflectance[node][lane];
        if (const auto* ggx = std::get_if<Ggx>(&bsdf)) block.glossy_alpha[lane] = ggx->alpha;
    }
}

void PieceArranger::append_blocks(const std::vector<MergedPiece>& pieces, PieceKind kind) {
    std::vector<PieceCenter> sorted;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Piece& triangle = pieces[i].triangle;
        if (kind_of(scene_.object_of(triangle.facet).material) == kind) {
            sorted.push_back({triangle.center(), i});
        }
    }
    sort_into_blocks(sorted);
    for (std::size_t begin = 0; begin < sorted.size(); begin += PieceBlock::kSize) {
        PieceBlock& block = set_.blocks.emplace_back();
        block.kind = kind;
        block.count = std::min(PieceBlock::kSize, sorted.size() - begin);
        Eigen::AlignedBox3d box;
        for (std::size_t lane = 0; lane < PieceBlock::kSize; ++lane) {
            const std::size_t index = sorted[begin + (lane < block.count ? lane : 0)].piece;
            fill_lane(block, lane, pieces[index]);
            if (lane >= block.count) {
                block.area_m2[lane] = 0.0;
                continue;
            }
            piece_ids_[index] =
                static_cast<std::uint32_t>((set_.blocks.size() - 1) * PieceBlock::kSize + lane);
            const auto& corners = pieces[index].triangle.corners;
            for (std::size_t i = 0; i < 3; ++i) {
                box.extend(corners[i]);
                const double edge = (corners[(i + 1) % 3] - corners[i]).norm();
                block.longest_edge_m = std::max(block.longest_edge_m, edge);
            }
        }
        set_.spheres.push_back({box.center(), 0.5 * box.diagonal().norm()});
        find_unit_spheres(block);
    }
}

bool PieceArranger::may_be_one_group(const PieceBlock& block, Range lanes) const {
    const auto normal = [&](std::size_t i) {
        return Vec3(block.normal_x[i], block.normal_y[i], block.normal_z[i]);
    };
    Eigen::AlignedBox3d box;
    for (std::size_t i = lanes.begin; i < lanes.end; ++i) {
        if (std::abs(normal(i).dot(normal(lanes.begin))) < kLeastGroupCosine) return false;
        if (scene_.facet(block.facet[i]).object != scene_.facet(block.facet[lanes.begin]).object) {
            return false;
        }
        for (std::size_t c = 0; c < 3; ++c) {
            box.extend(Vec3(block.x[c][i], block.y[c][i], block.z[c][i]));
        }
    }
    const double distance = (box.center() - scan_center_).norm();
    return box.diagonal().norm() <= kGroupSizePerDistance * std::sqrt(rules_.tolerance) * distance;
}

// Splits lanes in halves, as sort_into_blocks() did, until each part may be one group. The parts'
// pieces must also hang together: of two sheets, one may hide the other.
void PieceArranger::form_groups(std::size_t block, Range lanes) {
    const std::size_t count = lanes.end - lanes.begin;
    bool is_group = count == 1 || may_be_one_group(set_.blocks[block], lanes);
    if (is_group && count > 1) {
        const auto base = static_cast<std::uint32_t>(block * PieceBlock::kSize);
        std::vector<std::uint32_t> reached{base + static_cast<std::uint32_t>(lanes.begin)};
        std::array<bool, PieceBlock::kSize> seen{};
        seen[lanes.begin] = true;
        for (std::size_t next = 0; next < reached.size(); ++next) {
            const auto& lists = set_.piece_neighbours;
            for (std::uint32_t i = lists.begin[reached[next]]; i < lists.begin[reached[next] + 1];
                 ++i) {
                const std::uint32_t lane = lists.items[i] - base;  // wraps for earlier blocks
                if (lane < lanes.begin || lane >= lanes.end || seen[lane]) continue;
                seen[lane] = true;
                reached.push_back(lists.items[i]);
            }
        }
        is_group = reached.size() == count;
    }
    if (is_group) {
        set_.groups.push_back({static_cast<std::uint32_t>(block),
                               (~std::uint64_t{0} >> (PieceBlock::kSize - count)) << lanes.begin});
        return;
    }
    const std::size_t middle = lanes.begin + (count + 1) / 2;
    form_groups(block, {lanes.begin, middle});
    form_groups(block, {middle, lanes.end});
}

void PieceArranger::find_group_neighbours() {
    std::vector<std::uint32_t> group_of(set_.blocks.size() * PieceBlock::kSize);
    for (std::uint32_t g = 0; g < set_.groups.size(); ++g) {
        const PieceGroup& group = set_.groups[g];
        for_each_bit(group.lanes, [&](std::size_t lane) {
            group_of[group.block * PieceBlock::kSize + lane] = g;
        });
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    const NeighbourLists& lists = set_.piece_neighbours;
    for (const std::uint32_t piece : piece_ids_) {
        for (std::uint32_t i = lists.begin[piece]; i < lists.begin[piece + 1]; ++i) {
            const std::uint32_t other = group_of[lists.items[i]];
            if (group_of[piece] < other) pairs.emplace_back(group_of[piece], other);
        }
    }
    set_.group_neighbours = neighbour_lists(set_.groups.size(), pairs);
}

PieceSet PieceArranger::arrange(std::span<const Piece> pieces,
                                std::span<const std::uint32_t> clusters) {
    auto pairs = touching_pieces(pieces);
    const MergedPieces merged = merge_pieces(scene_, pieces, clusters, pairs);
    set_.num_pieces = merged.pieces.size();
    piece_ids_.resize(set_.num_pieces);
    for (const PieceKind kind :
         {PieceKind::Lambertian, PieceKind::Glossy, PieceKind::Retroreflective}) {
        append_blocks(merged.pieces, kind);
    }
    for (auto& [a, b] : pairs) {
        a = piece_ids_[merged.merged_of[a]];
        b = piece_ids_[merged.merged_of[b]];
    }
    std::erase_if(pairs, [](const auto& pair) { return pair.first == pair.second; });
    set_.piece_neighbours = neighbour_lists(set_.blocks.size() * PieceBlock::kSize, pairs);
    for (std::size_t block = 0; block < set_.blocks.size(); ++block) {
        set_.first_group.push_back(static_cast<std::uint32_t>(set_.groups.size()));
        form_groups(block, {0, set_.blocks[block].count});
    }
    set_.first_group.push_back(static_cast<std::uint32_t>(set_.groups.size()));
    find_group_neighbours();
    return std::move(set_);
}

}  // namespace renderer
