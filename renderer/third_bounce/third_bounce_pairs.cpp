// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/third_bounce_pairs.h"

#include "renderer/material/ggx.h"
#include "renderer/triangle/triangle_histogram.h"

namespace renderer {
namespace {

using core::Vec3;

using core::load;
using core::Simd;
using core::store;

using NodeWeights = std::array<Simd, ElementBlock::kNodes>;

using Nodes = std::array<SimdVec3, ElementBlock::kNodes>;

// Nodes of the elements of the SIMD group that starts at lane `begin`, relative to a wall point.
[[gnu::always_inline]] inline Nodes load_nodes(const ElementBlock& block,
                                               std::size_t begin,
                                               const WallPoint& point) {
    const Vec3& origin = point.position;
    Nodes nodes;
    for (std::size_t j = 0; j < 3; ++j) {
        nodes[j] = block.corners[j].load(begin, origin);
    }
    for (std::size_t j = 0; j < 3; ++j) {
        const SimdVec3& p = nodes[j];
        const SimdVec3& q = nodes[(j + 1) % 3];
        nodes[3 + j] = {0.5 * (p.x + q.x), 0.5 * (p.y + q.y), 0.5 * (p.z + q.z)};
    }
    nodes[6] = block.center.load(begin, origin);
    return nodes;
}

// Keeps products of an element's squared distances from becoming 0 [m^2].
constexpr double kMinSquaredDistance = 1e-40;

[[gnu::always_inline]] inline Simd squared_length(const SimdVec3& d) {
    return core::max(d.dot(d), kMinSquaredDistance);
}

// BSDF of glossy elements at their nodes [1/sr].
NodeWeights glossy_values(const ElementBlock& block,
                          std::size_t begin,
                          const PairEnd& light,
                          const PairEnd& sensor) {
    const Nodes from_light = load_nodes(block, begin, *light.point);
    const Nodes from_sensor = load_nodes(block, begin, *sensor.point);
    const Simd alpha = load(block.glossy_alpha, begin);
    const auto distance_to_plane = [&](const PairEnd& end) {
        const Simd side = load(end.table->side, begin);
        return core::max(side, -side);
    };
    const Simd light_height = distance_to_plane(light);
    const Simd sensor_height = distance_to_plane(sensor);
    NodeWeights values;
    for (std::size_t node = 0; node < values.size(); ++node) {
        const SimdVec3& in = from_light[node];
        const SimdVec3& out = from_sensor[node];
        const Simd per_in = 1.0 / core::sqrt(squared_length(in));
        const Simd per_out = 1.0 / core::sqrt(squared_length(out));
        const Simd cos_in = light_height * per_in;
        const Simd cos_out = sensor_height * per_out;
        // Of the sum of both directions: its squared length, and what of that is along the normal.
        const Simd up2 = (cos_in + cos_out) * (cos_in + cos_out);
        const Simd sum2 = core::max(2.0 + 2.0 * in.dot(out) * (per_in * per_out), up2);
        const Simd cos2 = up2 / sum2;
        values[node] = ggx_value<Simd>(core::kPi * load(block.reflectance[node], begin),
                                       alpha,
                                       ggx_normal_density<Simd>(alpha, cos2, 1.0 - cos2),
                                       cos_in,
                                       cos_out,
                                       0.5 * core::sqrt(sum2));
    }
    return values;
}

// Weights of the elements of the SIMD group that starts at lane `begin`.
[[gnu::always_inline]] inline NodeWeights weigh_nodes(const ElementBlock& block,
                                                      std::size_t begin,
                                                      const PairEnd& light,
                                                      const PairEnd& sensor) {
    NodeWeights weights;
    if (block.response.glossy) {
        weights = glossy_values(block, begin, light, sensor);
    } else {
        for (std::size_t node = 0; node < weights.size(); ++node) {
            weights[node] = load(block.reflectance[node], begin);
        }
    }
    for (std::size_t node = 0; node < weights.size(); ++node) {
        weights[node] *= load(light.table->factor[node], begin);
        if (!block.response.towards_source) {
            weights[node] *= load(sensor.table->factor[node], begin);
        }
    }
    return weights;
}

// Linear weights with the mean over the element, estimated from the nodes, and the differences
// between the corners; where a corner would be negative, these are scaled down until it is 0.
// Written to the lanes from `begin` on.
[[gnu::always_inline]] inline void fit_weights(const NodeWeights& k,
                                               std::size_t begin,
                                               TriangleLanes& fitted) {
    const Simd corner_mean = (k[0] + k[1] + k[2]) * (1.0 / 3.0);
    const Simd mean = 3.0 * kFractionOfCorner * corner_mean +
                      kFractionOfMiddle * (k[3] + k[4] + k[5]) + kFractionOfCenter * k[6];
    const Simd lowest = core::min(core::min(k[0], k[1]), k[2]) - corner_mean;
    Simd spread = 1.0;
    const core::SimdMask falls_below = lowest < -mean;
    if (falls_below.any()) spread = core::select(falls_below, mean / -lowest, 1.0);
    for (std::size_t c = 0; c < 3; ++c) {
        store(mean + spread * (k[c] - corner_mean), fitted.weight[c], begin);
    }
}

// With a single division, which takes as long as a dozen products.
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

// Weights of the visible part: the product of two linear functions, replaced by a linear one with
// the same integral.
std::array<double, 3> visible_weights(const std::array<double, 3>& weight, VisibilityMask mask) {
    const std::array<double, 3> fraction = visible_fraction(mask);
    std::array<double, 3> product{};
    for (std::size_t j = 0; j < 3; ++j) product[j] = weight[j] * fraction[j];
    const double sum = product[0] + product[1] + product[2];
    if (!(sum > 0.0)) return {0.0, 0.0, 0.0};
    const double integral =
        ((weight[0] + weight[1] + weight[2]) * (fraction[0] + fraction[1] + fraction[2]) + sum) /
        4.0;
    for (double& value : product) value *= integral / sum;
    return product;
}

// The parts of a SIMD group's elements that are visible from both ends.
using SimdGroupMasks = std::array<VisibilityMask, ElementBlock::kSimdWidth>;

SimdGroupMasks common_masks(const PairEnd& light, const PairEnd& sensor, std::size_t begin) {
    SimdGroupMasks masks;
    for (std::size_t j = 0; j < masks.size(); ++j) {
        const std::size_t i = begin + j;
        const bool same_side = light.table->side[i] * sensor.table->side[i] > 0.0;
        masks[j] = static_cast<VisibilityMask>(same_side ? light.masks[i] & sensor.masks[i] : 0);
    }
    return masks;
}

void keep_visible_weights(const SimdGroupMasks& masks, std::size_t begin, TriangleLanes& lanes) {
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

void compute_table(const ElementBlock& block,
                   const WallPoint& point,
                   SimdGroupMask simd_groups,
                   BlockTable& table) {
    const Vec3 n = point.normal;
    table.simd_groups = simd_groups;
    for_each_simd_group(simd_groups, [&](std::size_t begin) {
        const Nodes nodes = load_nodes(block, begin, point);
        const SimdVec3 normal = block.normal.load(begin);
        // All points of the element have the same distance from the wall point along its normal.
        const Simd side = -nodes[0].dot(normal);
        const Simd facing = core::max(side, -side);
        store(side, table.side, begin);
        std::array<Simd, ElementBlock::kNodes> d2;
        for (std::size_t node = 0; node < nodes.size(); ++node) {
            d2[node] = squared_length(nodes[node]);
        }
        const auto per_d2 = reciprocals(d2);
        for (std::size_t node = 0; node < nodes.size(); ++node) {
            const Simd front = core::max(nodes[node].dot(n), 0.0);
            store(front * facing * (per_d2[node] * per_d2[node]), table.factor[node], begin);
        }
        std::array<Simd, 3> segment;
        Simd per_segment = 0.0;  // mean
        for (std::size_t j = 0; j < 3; ++j) {
            segment[j] = core::sqrt(d2[j]);
            store(segment[j], table.segment_m[j], begin);
            per_segment += segment[j] * per_d2[j] * (1.0 / 3.0);
        }
        // The segment's second derivative along an edge is (|edge|^2 - (its rise)^2) / segment.
        for (std::size_t j = 0; j < 3; ++j) {
            const Simd rise = segment[(j + 2) % 3] - segment[(j + 1) % 3];
            const Simd squared = load(block.squared_edge[j], begin) - rise * rise;
            store(core::max(squared, 0.0) * per_segment, table.bend_m[j], begin);
        }
    });
}

void add_pair(const ElementBlock& block,
              const PairEnd& light,
              const PairEnd& sensor,
              const core::TimeAxis& axis,
              std::span<double> histogram) {
    TriangleLanes fitted;
    std::size_t count = 0;
    for_each_simd_group(
        light.table->simd_groups & sensor.table->simd_groups, [&](std::size_t begin) {
            const SimdGroupMasks masks = common_masks(light, sensor, begin);
            VisibilityMask any = 0;
            for (const VisibilityMask mask : masks) any = static_cast<VisibilityMask>(any | mask);
            if (any == 0) return;
            for (std::size_t c = 0; c < 3; ++c) {
                store(load(light.table->segment_m[c], begin) +
                          load(sensor.table->segment_m[c], begin),
                      fitted.opl_m[c],
                      count);
                store(load(light.table->bend_m[c], begin) + load(sensor.table->bend_m[c], begin),
                      fitted.bend_m[c],
                      count);
            }
            fit_weights(weigh_nodes(block, begin, light, sensor), count, fitted);
            keep_visible_weights(masks, count, fitted);
            store(load(block.area_m2, begin), fitted.area_m2, count);
            count += ElementBlock::kSimdWidth;
        });
    add_triangles(fitted, count, axis, histogram);
}

}  // namespace renderer
