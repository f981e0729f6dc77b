// SPDX-License-Identifier: MIT
// The closed form for triangles over which lengths bend: against sampling, exact arcs and the laws
// it must obey.
#include "renderer/core/random.h"
#include "renderer/triangle/triangle_histogram.h"
#include "tests/support/exact_arcs.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::TimeAxis;
using core::Vec3;
using test_support::relative_l2;
using Triple = std::array<double, 3>;

struct BentTriangle {
    Triple opl_m;
    Triple bend_m;
    Triple weight;

    double mean_weight() const { return (weight[0] + weight[1] + weight[2]) / 3.0; }
};

void put(const BentTriangle& triangle,
         double area_m2,
         std::size_t i,
         renderer::TriangleLanes& lanes) {
    for (std::size_t j = 0; j < 3; ++j) {
        lanes.opl_m[j][i] = triangle.opl_m[j];
        lanes.bend_m[j][i] = triangle.bend_m[j];
        lanes.weight[j][i] = triangle.weight[j];
    }
    lanes.area_m2[i] = area_m2;
}

std::vector<double> histogram_of(const BentTriangle& triangle, const TimeAxis& axis) {
    renderer::TriangleLanes lanes;
    put(triangle, 1.0, 0, lanes);
    std::vector<double> histogram(static_cast<std::size_t>(axis.num_bins));
    renderer::add_triangles(lanes, 1, axis, histogram);
    return histogram;
}

// Lengths of corners within `spread` of 1 m, bends up to `bend` along edges of a plane triangle:
// of a convex function, as segments are.
BentTriangle random_triangle(core::Rng& rng, double spread, double bend) {
    BentTriangle triangle;
    for (double& opl : triangle.opl_m) opl = 1.0 + spread * rng.uniform();
    for (double& weight : triangle.weight) weight = rng.uniform();
    const core::Vec2 a(rng.uniform(), rng.uniform());
    const core::Vec2 b(rng.uniform(), rng.uniform());
    const core::Vec2 across(rng.uniform() - 0.5, rng.uniform() - 0.5);
    const auto along = [&](const core::Vec2& edge) {
        return std::pow(edge.dot(across), 2) + 0.1 * edge.squaredNorm();
    };
    triangle.bend_m = {along(b - a), along(b), along(a)};
    const double most = std::max({triangle.bend_m[0], triangle.bend_m[1], triangle.bend_m[2]});
    for (double& value : triangle.bend_m) value *= bend / most;
    return triangle;
}

// Sums over the centres of steps^2 congruent triangles.
std::vector<double> sampled(const BentTriangle& triangle, const TimeAxis& axis, int steps) {
    std::vector<double> histogram(static_cast<std::size_t>(axis.num_bins));
    const auto add = [&](double l1, double l2) {
        const double l0 = 1.0 - l1 - l2;
        const auto mix = [&](const Triple& v) { return l0 * v[0] + l1 * v[1] + l2 * v[2]; };
        const auto& c = triangle.bend_m;
        const double opl =
            mix(triangle.opl_m) - 0.5 * (c[0] * l1 * l2 + c[1] * l0 * l2 + c[2] * l0 * l1);
        const auto bin = axis.bin_of(opl);
        if (bin) histogram[static_cast<std::size_t>(*bin)] += mix(triangle.weight);
    };
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; i + j < steps; ++j) {
            add((i + 1.0 / 3.0) / steps, (j + 1.0 / 3.0) / steps);
            if (i + j + 1 < steps) add((i + 2.0 / 3.0) / steps, (j + 2.0 / 3.0) / steps);
        }
    }
    for (double& value : histogram) value /= steps * steps;
    return histogram;
}

// The rest after the first order: of (bend / span)^2, and never much where a triangle is split.
TEST(BentTriangle, MatchesSampling) {
    core::Rng rng(test_support::seed_of("BentTriangle.MatchesSampling"), 0, 0);
    struct Case {
        double spread, bend, allowed;
    };
    for (const auto& [spread, bend, allowed] : {Case{0.1, 0.0, 4e-4},
                                                Case{0.1, 0.01, 6e-3},
                                                Case{0.1, 0.04, 6e-3},
                                                Case{0.02, 0.04, 2e-3},
                                                Case{0.0, 0.1, 2e-3},
                                                Case{1e-4, 0.02, 2e-3}}) {
        double sum2 = 0.0;
        for (int trial = 0; trial < 20; ++trial) {
            const BentTriangle triangle = random_triangle(rng, spread, bend);
            const TimeAxis axis{0.9 + 0.004 * rng.uniform(), 0.008, 40};
            const double error =
                relative_l2(histogram_of(triangle, axis), sampled(triangle, axis, 600));
            sum2 += error * error / 20.0;
        }
        EXPECT_LT(std::sqrt(sum2), allowed) << spread << " " << bend;
    }
}

// Flat to first order and strongly bent: after four splits, what is left bends over about two bins.
TEST(BentTriangle, IsSplitInto256Parts) {
    core::Rng rng(test_support::seed_of("BentTriangle.IsSplitInto256Parts"), 0, 0);
    double sum2 = 0.0;
    for (int trial = 0; trial < 6; ++trial) {
        const BentTriangle triangle = random_triangle(rng, 0.0, 1.5);
        const TimeAxis axis{0.7, 0.001, 301};
        sum2 +=
            std::pow(relative_l2(histogram_of(triangle, axis), sampled(triangle, axis, 2000)), 2);
    }
    EXPECT_LT(std::sqrt(sum2 / 6.0), 0.02);
}

TEST(BentTriangle, AllWeightArrivesAndNoBinIsNegative) {
    core::Rng rng(test_support::seed_of("BentTriangle.AllWeightArrives"), 0, 0);
    for (int trial = 0; trial < 2000; ++trial) {
        const double spread = std::exp(-9.0 * rng.uniform());
        const double bend = 0.5 * std::exp(-9.0 * rng.uniform());
        const BentTriangle triangle = random_triangle(rng, spread, bend);
        const double width = std::exp(-6.0 * rng.uniform());
        const TimeAxis axis{0.7 - width * rng.uniform(), width, static_cast<int>(2.0 / width) + 3};
        const auto histogram = histogram_of(triangle, axis);
        EXPECT_NEAR(test_support::sum_of(histogram) / triangle.mean_weight(), 1.0, 1e-12) << trial;
        for (const double value : histogram) EXPECT_GE(value, 0.0) << trial;
    }
}

// Lanes do not know of each other, whether they lie together or far apart; unused ones may hold
// anything.
TEST(BentTriangle, LanesAddUp) {
    core::Rng rng(test_support::seed_of("BentTriangle.LanesAddUp"), 0, 0);
    const TimeAxis axis{0.99, 0.002, 4000};
    for (const double distance : {0.0, 0.05, 7.0}) {
        for (std::size_t count = 1; count <= renderer::TriangleLanes::kSize; count += 3) {
            renderer::TriangleLanes lanes;
            std::vector<double> expected(static_cast<std::size_t>(axis.num_bins));
            for (std::size_t i = 0; i < count; ++i) {
                BentTriangle triangle = random_triangle(rng, 0.02, 0.01 * rng.uniform());
                const double shift = distance * (rng.uniform() - 0.1);
                for (double& opl : triangle.opl_m) opl += shift;
                if (rng.uniform() < 0.2) triangle.weight = {};
                put(triangle, 0.5 + rng.uniform(), i, lanes);
                const auto alone = histogram_of(triangle, axis);
                for (std::size_t bin = 0; bin < alone.size(); ++bin) {
                    expected[bin] += lanes.area_m2[i] * alone[bin];
                }
            }
            const BentTriangle none{{std::nan(""), 1.0, 1.0}, {}, {std::nan(""), 1e300, 1.0}};
            for (std::size_t i = count; i < renderer::TriangleLanes::kSize; ++i) {
                put(none, std::nan(""), i, lanes);
            }
            std::vector<double> histogram(expected.size());
            renderer::add_triangles(lanes, count, axis, histogram);
            for (std::size_t bin = 0; bin < expected.size(); ++bin) {
                EXPECT_NEAR(histogram[bin], expected[bin], 1e-12) << distance << " " << bin;
            }
        }
    }
}

// A part of the axis holds what the whole axis holds there, but for what rises again where the
// first order would have fallen.
TEST(BentTriangle, PartOfTheAxisHoldsItsBins) {
    core::Rng rng(test_support::seed_of("BentTriangle.PartOfTheAxis"), 0, 0);
    const TimeAxis whole{0.95, 0.01, 30};
    for (int trial = 0; trial < 200; ++trial) {
        const BentTriangle triangle =
            random_triangle(rng, 0.15 * rng.uniform(), 0.05 * rng.uniform());
        const auto all = histogram_of(triangle, whole);
        for (int first = 0; first < 30; first += 3) {
            const auto part = histogram_of(triangle, {whole.bin_begin_m(first), 0.01, 2});
            for (int bin = 0; bin < 2; ++bin) {
                EXPECT_NEAR(part[static_cast<std::size_t>(bin)],
                            all[static_cast<std::size_t>(first + bin)],
                            2e-3 * triangle.mean_weight())
                    << trial;
            }
        }
    }
}

// Weights linear, so that only lengths err: a piece's lengths follow from its corners and edges.
BentTriangle confocal_part(const std::array<Vec3, 3>& corners) {
    BentTriangle part;
    double mean_segment = 0.0;
    for (const Vec3& corner : corners) mean_segment += corner.norm() / 3.0;
    for (std::size_t j = 0; j < 3; ++j) {
        const Vec3& a = corners[(j + 1) % 3];
        const Vec3& b = corners[(j + 2) % 3];
        part.opl_m[j] = 2.0 * corners[j].norm();
        part.bend_m[j] =
            2.0 * ((b - a).squaredNorm() - std::pow(b.norm() - a.norm(), 2)) / mean_segment;
    }
    return part;
}

// The tilted triangle of triangle_histogram_test.cpp in few pieces: with kappa = h^2/(8 r w_r), w_r
// half a bin in range, 0.02 kappa, where linear lengths err by up to 0.1 kappa.
TEST(BentTriangle, ErrorAgainstExactArcsFollowsTheSizeRule) {
    const std::array<Vec3, 3> corners{
        Vec3(-0.2, -0.15, 0.7), Vec3(0.2, -0.1, 0.78), Vec3(-0.05, 0.22, 0.85)};
    const TimeAxis axis{1.2, 0.0096, 80};
    const auto arcs = test_support::confocal_arcs(corners, Vec3::Zero(), Vec3::UnitZ(), axis);
    for (const int steps : {2, 4, 8}) {
        const Vec3 e1 = (corners[1] - corners[0]) / steps;
        const Vec3 e2 = (corners[2] - corners[0]) / steps;
        const Vec3 area_vector = 0.5 * e1.cross(e2);
        const Vec3 normal = area_vector.normalized();
        std::vector<double> histogram(80);
        const auto add = [&](const std::array<Vec3, 3>& part) {
            BentTriangle bent = confocal_part(part);
            for (std::size_t j = 0; j < 3; ++j) {
                const Vec3& d = part[j];
                bent.weight[j] = area_vector.norm() * std::pow(d.z() * normal.dot(d), 2) /
                                 std::pow(d.squaredNorm(), 4);
            }
            const auto added = histogram_of(bent, axis);
            for (std::size_t i = 0; i < 80; ++i) histogram[i] += added[i];
        };
        for (int i = 0; i < steps; ++i) {
            for (int j = 0; i + j < steps; ++j) {
                const Vec3 p = corners[0] + i * e1 + j * e2;
                add({p, p + e1, p + e2});
                if (i + j + 1 < steps) add({p + e1, p + e1 + e2, p + e2});
            }
        }
        // Linear weights overestimate; the shape is what is asked.
        const double scale = test_support::sum_of(arcs) / test_support::sum_of(histogram);
        for (double& value : histogram) value *= scale;
        const double kappa = e1.squaredNorm() / (8.0 * 0.75 * axis.bin_width_m / 2.0);
        EXPECT_LT(relative_l2(histogram, arcs), 0.02 * kappa) << steps;
    }
}

}  // namespace
