// SPDX-License-Identifier: MIT
#include "renderer/third_bounce_pairs.h"

#include "renderer/core/triangle_histogram.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::size_t kSize = PieceBlock::kSize;

// Weights of all pieces of a block at the nodes, and what follows for the closed form.
struct alignas(64) BlockKnots {
    std::array<PieceBlock::Lanes, PieceBlock::kNodes> node_weight;
    core::TriangleLanes fitted;
};

Vec3 node_of(const PieceBlock& block, std::size_t node, std::size_t i) {
    if (node == 6) return {block.center_x[i], block.center_y[i], block.center_z[i]};
    const auto corner = [&](std::size_t c) {
        return Vec3(block.x[c][i], block.y[c][i], block.z[c][i]);
    };
    return node < 3 ? corner(node) : 0.5 * (corner(node - 3) + corner((node - 2) % 3));
}

// Replaces the nominal reflectance of one piece by its BSDF.
void apply_bsdf(const PieceBlock& block,
                std::size_t i,
                const PairEnd& light,
                const PairEnd& sensor,
                BlockKnots& knots) {
    const Vec3 normal(block.normal_x[i], block.normal_y[i], block.normal_z[i]);
    const Vec3 edge = node_of(block, 1, i) - node_of(block, 0, i);
    const core::Mat3 facet_from_world = core::frame_from_normal(normal, edge).transpose();
    for (std::size_t node = 0; node < PieceBlock::kNodes; ++node) {
        const Vec3 position = node_of(block, node, i);
        const Vec3 in = (light.point->position - position).normalized();
        const Vec3 out = (sensor.point->position - position).normalized();
        const double value =
            evaluate_bsdf(block.glossy[i], facet_from_world * in, facet_from_world * out);
        knots.node_weight[node][i] =
            value * light.table->factor[node][i] * sensor.table->factor[node][i];
    }
}

void weigh_nodes(const PieceBlock& block,
                 const PairEnd& light,
                 const PairEnd& sensor,
                 BlockKnots& knots) {
    for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < kSize; ++i) {
            knots.fitted.opl_m[j][i] = light.table->leg_m[j][i] + sensor.table->leg_m[j][i];
            knots.fitted.bend_m[j][i] = light.table->bend_m[j][i] + sensor.table->bend_m[j][i];
        }
    }
    if (block.kind == PieceKind::Glossy) {
        for (std::size_t i = 0; i < block.count; ++i) {
            if ((light.masks[i] & sensor.masks[i]) == 0) continue;
            apply_bsdf(block, i, light, sensor, knots);
        }
        return;
    }
    const bool retro = block.kind == PieceKind::Retroreflective;
    for (std::size_t node = 0; node < PieceBlock::kNodes; ++node) {
        const auto& towards_light = light.table->factor[node];
        const auto& towards_sensor = sensor.table->factor[node];
        for (std::size_t i = 0; i < kSize; ++i) {
            knots.node_weight[node][i] =
                block.reflectance[node][i] * towards_light[i] * (retro ? 1.0 : towards_sensor[i]);
        }
    }
}

// By value: with std::min, compilers choose between addresses instead.
double lower_of(double a, double b) {
    return b < a ? b : a;
}

// Coordinates of a point of every piece.
struct Point {
    const PieceBlock::Lanes& x;
    const PieceBlock::Lanes& y;
    const PieceBlock::Lanes& z;
};

// Linear weights with the mean over the piece, as the nodes tell it, and the corners' differences;
// where a corner would fall below 0, all of them shrink until it does not.
void fit_weights(BlockKnots& knots) {
    const auto& k = knots.node_weight;
    for (std::size_t i = 0; i < kSize; ++i) {
        const double corner_mean = (k[0][i] + k[1][i] + k[2][i]) * (1.0 / 3.0);
        const double mean = 3.0 * kShareOfCorner * corner_mean +
                            kShareOfMiddle * (k[3][i] + k[4][i] + k[5][i]) +
                            kShareOfCenter * k[6][i];
        const double lowest = lower_of(k[0][i], lower_of(k[1][i], k[2][i])) - corner_mean;
        const double most = mean / -lowest;
        const double spread = lowest < -mean ? most : 1.0;
        knots.fitted.weight[0][i] = mean + spread * (k[0][i] - corner_mean);
        knots.fitted.weight[1][i] = mean + spread * (k[1][i] - corner_mean);
        knots.fitted.weight[2][i] = mean + spread * (k[2][i] - corner_mean);
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

}  // namespace

void compute_table(const PieceBlock& block, const WallPoint& point, BlockTable& table) {
    const Vec3 w = point.position;
    const Vec3 n = point.normal;
    alignas(64) std::array<PieceBlock::Lanes, 3> leg;
    alignas(64) PieceBlock::Lanes facing;
    for (std::size_t i = 0; i < kSize; ++i) {
        // All points of the piece have the same distance from w along its normal.
        const double side = (w.x() - block.x[0][i]) * block.normal_x[i] +
                            (w.y() - block.y[0][i]) * block.normal_y[i] +
                            (w.z() - block.z[0][i]) * block.normal_z[i];
        table.side[i] = side;
        facing[i] = std::abs(side);
    }
    // At a node, the mean of two points; a corner or the centre is that twice.
    const auto look_at = [&](std::size_t node, const Point& p, const Point& q) {
        auto& factor = table.factor[node];
        for (std::size_t i = 0; i < kSize; ++i) {
            const double x = 0.5 * (p.x[i] + q.x[i]) - w.x();
            const double y = 0.5 * (p.y[i] + q.y[i]) - w.y();
            const double z = 0.5 * (p.z[i] + q.z[i]) - w.z();
            const double d2 = std::max(x * x + y * y + z * z, 1e-200);
            const double front = std::max(0.0, x * n.x() + y * n.y() + z * n.z());
            factor[i] = front * facing[i] / (d2 * d2);
            if (node < 3) leg[node][i] = std::sqrt(d2);
        }
    };
    const auto corner = [&](std::size_t j) { return Point{block.x[j], block.y[j], block.z[j]}; };
    const Point center{block.center_x, block.center_y, block.center_z};
    for (std::size_t j = 0; j < 3; ++j) {
        look_at(j, corner(j), corner(j));
        look_at(3 + j, corner(j), corner((j + 1) % 3));
    }
    look_at(6, center, center);
    for (std::size_t i = 0; i < kSize; ++i) {
        const double a = leg[0][i];
        const double b = leg[1][i];
        const double c = leg[2][i];
        // The leg's second derivative along an edge is (|edge|^2 - (its rise)^2) / leg.
        const double per_leg = 3.0 / (a + b + c);
        const auto bend = [&](std::size_t j, double rise) {
            table.bend_m[j][i] = std::max(0.0, block.squared_edge[j][i] - rise * rise) * per_leg;
        };
        bend(0, c - b);
        bend(1, a - c);
        bend(2, b - a);
    }
    table.leg_m = leg;
}

void add_pair(const PieceBlock& block,
              const PairEnd& light,
              const PairEnd& sensor,
              const core::TimeAxis& axis,
              std::span<double> histogram) {
    const auto common_mask = [&](std::size_t i) {
        const bool same_side = light.table->side[i] * sensor.table->side[i] > 0.0;
        return static_cast<VisibilityMask>(same_side ? light.masks[i] & sensor.masks[i] : 0);
    };
    std::array<VisibilityMask, kSize> mask;
    VisibilityMask any = 0;
    for (std::size_t i = 0; i < kSize; ++i) {
        mask[i] = common_mask(i);
        any = static_cast<VisibilityMask>(any | mask[i]);
    }
    if (any == 0) return;
    BlockKnots knots;
    weigh_nodes(block, light, sensor, knots);
    fit_weights(knots);
    auto& weight = knots.fitted.weight;
    for (std::size_t i = 0; i < block.count; ++i) {
        if (mask[i] == kAllVisible) continue;
        const std::array<double, 3> all{weight[0][i], weight[1][i], weight[2][i]};
        const auto visible = mask[i] != 0 ? visible_weights(all, mask[i]) : std::array<double, 3>{};
        for (std::size_t j = 0; j < 3; ++j) weight[j][i] = visible[j];
    }
    core::add_triangles(knots.fitted, {block.area_m2.data(), block.count}, axis, histogram);
}

}  // namespace renderer
