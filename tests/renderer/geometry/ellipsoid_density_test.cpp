// SPDX-License-Identifier: MIT
// Samples of the ellipsoidal connection against their density, and that against areas.
#include "renderer/core/random.h"
#include "renderer/geometry/ellipsoid.h"
#include "tests/renderer/geometry/ellipsoid_configurations.h"
#include "tests/support/inverse_sampling.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace {

using core::Vec2;
using core::Vec3;
using ellipsoid_test::Configuration;
using ellipsoid_test::configurations;
using ellipsoid_test::draw_from;
using renderer::Facet;

// Cells of the triangle for which the density is integrated: [i][j] of the unit square that
// sample_triangle() maps to the triangle, area by area.
class Cells {
 public:
    static constexpr std::size_t kSide = 5;
    static constexpr std::size_t kNone = kSide * kSide;  ///< cell of draws without a sample

    static std::size_t of(const Facet& facet, const Vec3& x) {
        const Vec3 offset = x - facet.corner;
        const double twice = 2.0 * facet.area_m2;
        const double b1 = std::max(0.0, offset.cross(facet.edge2).dot(facet.normal) / twice);
        const double b2 = std::max(0.0, facet.edge1.cross(offset).dot(facet.normal) / twice);
        const double sum = std::max(1.0, b1 + b2);
        const Vec2 u = test_support::invert_triangle({b1 / sum, b2 / sum});
        const auto index = [](double v) {
            return std::min(kSide - 1, static_cast<std::size_t>(v * double(kSide)));
        };
        return index(u.x()) * kSide + index(u.y());
    }
};

// Integrals over the cells of the density and of the indicator of lengths in the interval.
struct Integrals {
    std::vector<double> probability = std::vector<double>(Cells::kNone + 1);
    double band_area = 0.0;
    double hits = 0.0;  ///< points with lengths in the interval
};

// By random points. Near a corner that the ellipsoid reaches first the density grows as one over
// the distance r, so points are drawn with density 1/r about each corner: on the line across the
// triangle at the fraction t of the way from corner k, t uniform, which has the area density 1/(2 A
// t).
Integrals integrate(const Configuration& c, int points_per_side, core::Rng& rng) {
    Integrals integrals;
    double total = 0.0;
    const double count = 3.0 * points_per_side * points_per_side;
    for (int i = 0; i < points_per_side * points_per_side * 3; ++i) {
        const std::size_t corner = static_cast<std::size_t>(i % 3);
        const int cell = i / 3;
        const double t = (cell / points_per_side + rng.uniform()) / points_per_side;
        const double v = (cell % points_per_side + rng.uniform()) / points_per_side;
        std::array<double, 3> b{};
        b[corner] = 1.0 - t;
        b[(corner + 1) % 3] = t * v;
        b[(corner + 2) % 3] = t * (1.0 - v);
        const Vec3 x = c.facet.point(b[1], b[2]);
        const double length = c.foci.opl_m(x);
        if (length < c.lengths.low_m || length > c.lengths.high_m) continue;
        ++integrals.hits;
        double point_density = 0.0;
        for (const double weight : b)
            point_density += 1.0 / (6.0 * c.facet.area_m2 * (1.0 - weight));
        integrals.band_area += 1.0 / (count * point_density);
        const double value =
            pdf_ellipsoid(c.foci, c.facet, x) / c.lengths.width_m() / (count * point_density);
        integrals.probability[Cells::of(c.facet, x)] += value;
        total += value;
    }
    integrals.probability[Cells::kNone] = std::max(0.0, 1.0 - total);
    return integrals;
}

// As many points as it takes for about `wanted` of them to have lengths in the interval.
Integrals integrate_well(const Configuration& c, double wanted, core::Rng& rng) {
    constexpr int kPilot = 100;
    const double hits = std::max(1.0, integrate(c, kPilot, rng).hits);
    const int side = static_cast<int>(std::min(1500.0, kPilot * std::sqrt(wanted / hits)));
    return integrate(c, side, rng);
}

TEST(EllipsoidalConnection, SamplesMatchTheirDensity) {
    constexpr int kDraws = 10'000;
    core::Rng rng(test_support::seed_of("SamplesMatch"), 0, 0);
    const auto all = configurations("SamplesMatch");
    const double level = test_support::sidak_level(1e-3, all.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Configuration& c = all[k];
        std::vector<double> observed(Cells::kNone + 1);
        for (int i = 0; i < kDraws; ++i) {
            const auto draw = draw_from(c, rng);
            ++observed[draw ? Cells::of(c.facet, draw->connection.position) : Cells::kNone];
        }
        std::vector<double> expected = integrate_well(c, 150'000, rng).probability;
        for (double& value : expected) value *= kDraws;
        // One minus the integral is no more than its error where every draw gives a sample.
        if (expected[Cells::kNone] < 10.0) {
            expected[0] += expected[Cells::kNone];
            observed[0] += observed[Cells::kNone];
            expected[Cells::kNone] = observed[Cells::kNone] = 0.0;
        }
        const double p = test_support::chi_square_p_value(observed, expected);
        EXPECT_GT(p, level) << c.name << " " << k;
        if (p > level) continue;
        for (std::size_t i = 0; i < observed.size(); ++i) {
            std::printf("cell %zu observed %.0f expected %.1f\n", i, observed[i], expected[i]);
        }
    }
}

// E[1 / pdf_area], 0 for no sample, is the area where lengths lie in the interval.
TEST(EllipsoidalConnection, MeanInverseDensityIsTheAreaOfTheBand) {
    constexpr int kDraws = 20'000;
    core::Rng rng(test_support::seed_of("MeanInverse"), 0, 0);
    const auto all = configurations("MeanInverse");
    const double level = test_support::sidak_level(1e-3, all.size());
    for (const Configuration& c : all) {
        double sum = 0.0;
        double squares = 0.0;
        for (int i = 0; i < kDraws; ++i) {
            const auto draw = draw_from(c, rng);
            if (!draw) continue;
            const double area = c.lengths.width_m() / draw->connection.pdf_area_per_pdf_opl;
            sum += area;
            squares += area * area;
        }
        const double mean = sum / kDraws;
        const double sigma = std::sqrt((squares / kDraws - mean * mean) / kDraws);
        const double expected = integrate_well(c, 50'000, rng).band_area;
        const double grid = 2e-3 * expected;  // what the jittered points may be off
        EXPECT_GT(test_support::normal_tail((mean - expected) / (std::hypot(sigma, grid) + 1e-300)),
                  level)
            << c.name << " mean " << mean << " expected " << expected << " sigma " << sigma;
    }
}

}  // namespace
