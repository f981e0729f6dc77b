// SPDX-License-Identifier: MIT
#include "renderer/third_bounce_pairs.h"

#include "renderer/core/triangle_histogram.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

using core::load;
using core::Simd;
using core::store;

using NodeWeights = std::array<Simd, PieceBlock::kNodes>;

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
[[gnu::always_inline]] inline NodeWeights weigh_nodes(const PieceBlock& block,
                                                      std::size_t begin,
                                                      const PairEnd& light,
                                                      const PairEnd& sensor) {
    NodeWeights weights;
    if (block.kind == PieceKind::Glossy) {
        alignas(64) std::array<UnitLanes, PieceBlock::kNodes> values{};
        for (std::size_t j = 0; j < PieceBlock::kUnitSize; ++j) {
            const std::size_t i = begin + j;
            if ((light.masks[i] & sensor.masks[i]) == 0) continue;
            std::array<double, PieceBlock::kNodes> of_piece;
            weigh_by_bsdf(block, i, light, sensor, of_piece);
            for (std::size_t node = 0; node < of_piece.size(); ++node) {
                values[node][j] = of_piece[node];
            }
        }
        for (std::size_t node = 0; node < weights.size(); ++node) {
            weights[node] = load(values[node], 0);
        }
        return weights;
    }
    for (std::size_t node = 0; node < weights.size(); ++node) {
        weights[node] =
            load(block.reflectance[node], begin) * load(light.table->factor[node], begin);
        if (block.kind != PieceKind::Retroreflective) {
            weights[node] *= load(sensor.table->factor[node], begin);
        }
    }
    return weights;
}

// Linear weights with the mean over the piece, as the nodes tell it, and the corners' differences;
// where a corner would fall below 0, all of them shrink until it does not. Into lanes from `begin`.
[[gnu::always_inline]] inline void fit_weights(const NodeWeights& k,
                                               std::size_t begin,
                                               core::TriangleLanes& fitted) {
    const Simd corner_mean = (k[0] + k[1] + k[2]) * (1.0 / 3.0);
    const Simd mean = 3.0 * kShareOfCorner * corner_mean + kShareOfMiddle * (k[3] + k[4] + k[5]) +
                      kShareOfCenter * k[6];
    const Simd lowest = core::smaller_of(core::smaller_of(k[0], k[1]), k[2]) - corner_mean;
    Simd spread = 1.0;
    const core::SimdMask falls_below = lowest < -mean;
    if (falls_below.any()) spread = core::select(falls_below, mean / -lowest, 1.0);
    for (std::size_t c = 0; c < 3; ++c) {
        store(mean + spread * (k[c] - corner_mean), fitted.weight[c], begin);
    }
}

// Keeps products of a piece's squared distances from becoming 0 [m^2].
constexpr double kLeastSquaredDistance = 1e-40;

// By one division, which takes as long as a dozen products.
template <std::size_t N>
[[gnu::always_inline]] inline std::array<Simd, N> reciprocals(const std::array<Simd, N>& values) {
    std::array<Simd, N> result;  // first the products of the values before
    Simd product = values[0];
    for (std::size_t i = 1; i < N; ++i) {
        result[i] = product;
        product *= values[i];
    }
    Simd per = 1.0 / product;
    for (std::size_t i = N - 1; i > 0; --i) {
        result[i] *= per;
        per *= values[i];
    }
    result[0] = per;
    return result;
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

}  // namespace

void compute_table(const PieceBlock& block,
                   const WallPoint& point,
                   UnitMask units,
                   BlockTable& table) {
    const Vec3 w = point.position;
    const Vec3 n = point.normal;
    table.units = units;
    for_each_unit(units, [&](std::size_t begin) {
        std::array<UnitPoints, 3> corners;
        for (std::size_t j = 0; j < 3; ++j) {
            corners[j] = load_points(block.x[j], block.y[j], block.z[j], begin, w);
        }
        const UnitPoints normal =
            load_points(block.normal_x, block.normal_y, block.normal_z, begin, Vec3::Zero());
        // All points of the piece have the same distance from w along its normal.
        const Simd side = -corners[0].dot(normal);
        const Simd facing = core::larger_of(side, -side);
        store(side, table.side, begin);
        std::array<UnitPoints, PieceBlock::kNodes> nodes;
        for (std::size_t j = 0; j < 3; ++j) {
            const UnitPoints& p = corners[j];
            const UnitPoints& q = corners[(j + 1) % 3];
            nodes[j] = p;
            nodes[3 + j] = {0.5 * (p.x + q.x), 0.5 * (p.y + q.y), 0.5 * (p.z + q.z)};
        }
        nodes[6] = load_points(block.center_x, block.center_y, block.center_z, begin, w);
        std::array<Simd, PieceBlock::kNodes> d2;
        for (std::size_t node = 0; node < nodes.size(); ++node) {
            d2[node] = core::larger_of(nodes[node].dot(nodes[node]), kLeastSquaredDistance);
        }
        const auto per_d2 = reciprocals(d2);
        for (std::size_t node = 0; node < nodes.size(); ++node) {
            const Simd front = core::larger_of(nodes[node].dot(n), 0.0);
            store(front * facing * (per_d2[node] * per_d2[node]), table.factor[node], begin);
        }
        std::array<Simd, 3> leg;
        Simd per_leg = 0.0;  // mean
        for (std::size_t j = 0; j < 3; ++j) {
            leg[j] = core::square_root(d2[j]);
            store(leg[j], table.leg_m[j], begin);
            per_leg += leg[j] * per_d2[j] * (1.0 / 3.0);
        }
        // The leg's second derivative along an edge is (|edge|^2 - (its rise)^2) / leg.
        for (std::size_t j = 0; j < 3; ++j) {
            const Simd rise = leg[(j + 2) % 3] - leg[(j + 1) % 3];
            const Simd squared = load(block.squared_edge[j], begin) - rise * rise;
            store(core::larger_of(squared, 0.0) * per_leg, table.bend_m[j], begin);
        }
    });
}

void add_pair(const PieceBlock& block,
              const PairEnd& light,
              const PairEnd& sensor,
              const core::TimeAxis& axis,
              std::span<double> histogram) {
    core::TriangleLanes fitted;
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
        fit_weights(weigh_nodes(block, begin, light, sensor), count, fitted);
        keep_visible_weights(masks, count, fitted);
        store(load(block.area_m2, begin), fitted.area_m2, count);
        count += PieceBlock::kUnitSize;
    });
    core::add_triangles(fitted, count, axis, histogram);
}

}  // namespace renderer
