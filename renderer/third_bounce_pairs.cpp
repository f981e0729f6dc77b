// SPDX-License-Identifier: MIT
#include "renderer/third_bounce_pairs.h"

#include "renderer/core/triangle_histogram.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::size_t kSize = PieceBlock::kSize;

// A point of each piece of a unit.
struct UnitPoints {
    UnitArray x, y, z;
};

using NodeWeights = std::array<UnitLanes, PieceBlock::kNodes>;

Vec3 node_of(const PieceBlock& block, std::size_t node, std::size_t i) {
    if (node == 6) return {block.center_x[i], block.center_y[i], block.center_z[i]};
    const auto corner = [&](std::size_t c) {
        return Vec3(block.x[c][i], block.y[c][i], block.z[c][i]);
    };
    return node < 3 ? corner(node) : 0.5 * (corner(node - 3) + corner((node - 2) % 3));
}

// Weights of one glossy piece at the nodes.
void weigh_by_bsdf(const PieceBlock& block,
                   std::size_t i,
                   const PairEnd& light,
                   const PairEnd& sensor,
                   std::array<double, PieceBlock::kNodes>& weights) {
    const Vec3 normal(block.normal_x[i], block.normal_y[i], block.normal_z[i]);
    const Vec3 edge = node_of(block, 1, i) - node_of(block, 0, i);
    const core::Mat3 facet_from_world = core::frame_from_normal(normal, edge).transpose();
    for (std::size_t node = 0; node < PieceBlock::kNodes; ++node) {
        const Vec3 position = node_of(block, node, i);
        const Vec3 in = (light.point->position - position).normalized();
        const Vec3 out = (sensor.point->position - position).normalized();
        const double value =
            evaluate_bsdf(block.glossy[i], facet_from_world * in, facet_from_world * out);
        weights[node] = value * light.table->factor[node][i] * sensor.table->factor[node][i];
    }
}

// Weights of the pieces of the unit that starts at lane `begin`.
void weigh_nodes(const PieceBlock& block,
                 std::size_t begin,
                 const PairEnd& light,
                 const PairEnd& sensor,
                 NodeWeights& weights) {
    if (block.kind == PieceKind::Glossy) {
        for (std::size_t j = 0; j < PieceBlock::kUnitSize; ++j) {
            const std::size_t i = begin + j;
            std::array<double, PieceBlock::kNodes> of_piece{};
            if ((light.masks[i] & sensor.masks[i]) != 0) {
                weigh_by_bsdf(block, i, light, sensor, of_piece);
            }
            for (std::size_t node = 0; node < PieceBlock::kNodes; ++node) {
                weights[node][j] = of_piece[node];
            }
        }
        return;
    }
    for (std::size_t node = 0; node < PieceBlock::kNodes; ++node) {
        UnitArray weight =
            load(block.reflectance[node], begin) * load(light.table->factor[node], begin);
        if (block.kind != PieceKind::Retroreflective) {
            weight *= load(sensor.table->factor[node], begin);
        }
        weight.copy_to(weights[node].data(), std::experimental::element_aligned);
    }
}

// By value: with std::min, compilers choose between addresses instead.
double lower_of(double a, double b) {
    return b < a ? b : a;
}

// Linear weights with the mean over the piece, as the nodes tell it, and the corners' differences;
// where a corner would fall below 0, all of them shrink until it does not. Into lanes from `begin`.
void fit_weights(const NodeWeights& k, std::size_t begin, core::TriangleLanes& fitted) {
    for (std::size_t j = 0; j < PieceBlock::kUnitSize; ++j) {
        const double corner_mean = (k[0][j] + k[1][j] + k[2][j]) * (1.0 / 3.0);
        const double mean = 3.0 * kShareOfCorner * corner_mean +
                            kShareOfMiddle * (k[3][j] + k[4][j] + k[5][j]) +
                            kShareOfCenter * k[6][j];
        const double lowest = lower_of(k[0][j], lower_of(k[1][j], k[2][j])) - corner_mean;
        const double most = mean / -lowest;
        const double spread = lowest < -mean ? most : 1.0;
        fitted.weight[0][begin + j] = mean + spread * (k[0][j] - corner_mean);
        fitted.weight[1][begin + j] = mean + spread * (k[1][j] - corner_mean);
        fitted.weight[2][begin + j] = mean + spread * (k[2][j] - corner_mean);
    }
}

// Weights of the visible part: the product of two linear functions, made linear again with its
// integral kept.
std::array<double, 3> visible_weights(const std::array<double, 3>& weight, VisibilityMask mask) {
    const std::array<double, 3> share = visible_share(mask);
    std::array<double, 3> product{};
    for (std::size_t j = 0; j < 3; ++j) product[j] = weight[j] * share[j];
    const double sum = product[0] + product[1] + product[2];
    if (!(sum > 0.0)) return {0.0, 0.0, 0.0};
    const double integral =
        ((weight[0] + weight[1] + weight[2]) * (share[0] + share[1] + share[2]) + sum) / 4.0;
    for (double& value : product) value *= integral / sum;
    return product;
}

// What both ends see of the pieces of a unit.
using UnitMasks = std::array<VisibilityMask, PieceBlock::kUnitSize>;

UnitMasks common_masks(const PairEnd& light, const PairEnd& sensor, std::size_t begin) {
    UnitMasks masks;
    for (std::size_t j = 0; j < masks.size(); ++j) {
        const std::size_t i = begin + j;
        const bool same_side = light.table->side[i] * sensor.table->side[i] > 0.0;
        masks[j] = static_cast<VisibilityMask>(same_side ? light.masks[i] & sensor.masks[i] : 0);
    }
    return masks;
}

void keep_visible_weights(const UnitMasks& masks, std::size_t begin, core::TriangleLanes& lanes) {
    auto& weight = lanes.weight;
    for (std::size_t j = 0; j < masks.size(); ++j) {
        if (masks[j] == kAllVisible) continue;
        const std::size_t i = begin + j;
        const std::array<double, 3> all{weight[0][i], weight[1][i], weight[2][i]};
        const auto visible =
            masks[j] != 0 ? visible_weights(all, masks[j]) : std::array<double, 3>{};
        for (std::size_t c = 0; c < 3; ++c) weight[c][i] = visible[c];
    }
}

UnitMask units_seen(const VisibilityMask* masks) {
    UnitMask units = 0;
    for (std::size_t u = 0; u < PieceBlock::kUnits; ++u) {
        VisibilityMask any = 0;
        for (std::size_t j = 0; j < PieceBlock::kUnitSize; ++j) {
            any = static_cast<VisibilityMask>(any | masks[u * PieceBlock::kUnitSize + j]);
        }
        units |= UnitMask{any != 0} << u;
    }
    return units;
}

}  // namespace

void compute_table(const PieceBlock& block,
                   const WallPoint& point,
                   const VisibilityMask* masks,
                   BlockTable& table) {
    const Vec3 w = point.position;
    const Vec3 n = point.normal;
    table.units = units_seen(masks);
    for_each_unit(table.units, [&](std::size_t begin) {
        const auto relative = [&](const PieceBlock::Lanes& x,
                                  const PieceBlock::Lanes& y,
                                  const PieceBlock::Lanes& z) {
            return UnitPoints{
                load(x, begin) - w.x(), load(y, begin) - w.y(), load(z, begin) - w.z()};
        };
        const std::array<UnitPoints, 3> corners{relative(block.x[0], block.y[0], block.z[0]),
                                                relative(block.x[1], block.y[1], block.z[1]),
                                                relative(block.x[2], block.y[2], block.z[2])};
        // All points of the piece have the same distance from w along its normal.
        const UnitArray side = -(corners[0].x * load(block.normal_x, begin) +
                                 corners[0].y * load(block.normal_y, begin) +
                                 corners[0].z * load(block.normal_z, begin));
        const UnitArray facing = larger_of(side, -side);
        store(side, table.side, begin);
        // Returns the squared distances.
        const auto look_at = [&](std::size_t node, const UnitPoints& p) -> UnitArray {
            const UnitArray d2 =
                larger_of(UnitArray(p.x * p.x + p.y * p.y + p.z * p.z), UnitArray(1e-200));
            const UnitArray front =
                larger_of(UnitArray(p.x * n.x() + p.y * n.y() + p.z * n.z()), UnitArray(0.0));
            store(front * facing / (d2 * d2), table.factor[node], begin);
            return d2;
        };
        std::array<UnitArray, 3> leg;
        for (std::size_t j = 0; j < 3; ++j) {
            const UnitPoints& p = corners[j];
            const UnitPoints& q = corners[(j + 1) % 3];
            leg[j] = square_root(look_at(j, p));
            store(leg[j], table.leg_m[j], begin);
            look_at(3 + j, {0.5 * (p.x + q.x), 0.5 * (p.y + q.y), 0.5 * (p.z + q.z)});
        }
        look_at(6, relative(block.center_x, block.center_y, block.center_z));
        // The leg's second derivative along an edge is (|edge|^2 - (its rise)^2) / leg.
        const UnitArray per_leg = 3.0 / (leg[0] + leg[1] + leg[2]);
        for (std::size_t j = 0; j < 3; ++j) {
            const UnitArray rise = leg[(j + 2) % 3] - leg[(j + 1) % 3];
            const UnitArray squared = load(block.squared_edge[j], begin) - rise * rise;
            store(larger_of(squared, UnitArray(0.0)) * per_leg, table.bend_m[j], begin);
        }
    });
}

void add_pair(const PieceBlock& block,
              const PairEnd& light,
              const PairEnd& sensor,
              const core::TimeAxis& axis,
              std::span<double> histogram) {
    core::TriangleLanes fitted;
    alignas(64) PieceBlock::Lanes area_m2;
    std::size_t count = 0;
    for_each_unit(light.table->units & sensor.table->units, [&](std::size_t begin) {
        const UnitMasks masks = common_masks(light, sensor, begin);
        VisibilityMask any = 0;
        for (const VisibilityMask mask : masks) any = static_cast<VisibilityMask>(any | mask);
        if (any == 0) return;
        for (std::size_t c = 0; c < 3; ++c) {
            store(load(light.table->leg_m[c], begin) + load(sensor.table->leg_m[c], begin),
                  fitted.opl_m[c],
                  count);
            store(load(light.table->bend_m[c], begin) + load(sensor.table->bend_m[c], begin),
                  fitted.bend_m[c],
                  count);
        }
        alignas(64) NodeWeights weights;
        weigh_nodes(block, begin, light, sensor, weights);
        fit_weights(weights, count, fitted);
        keep_visible_weights(masks, count, fitted);
        std::copy_n(block.area_m2.data() + begin, PieceBlock::kUnitSize, area_m2.data() + count);
        count += PieceBlock::kUnitSize;
    });
    core::add_triangles(fitted, {area_m2.data(), count}, axis, histogram);
}

}  // namespace renderer
