// SPDX-License-Identifier: MIT
// Laws of the ellipsoidal connection, on random and on degenerate foci, lengths and triangles.
#include "renderer/geometry/ellipsoid.h"

#include "renderer/core/random.h"
#include "renderer/core/sampling.h"
#include "tests/renderer/geometry/ellipsoid_configurations.h"
#include "tests/support/inverse_sampling.h"
#include "tests/support/random_geometry.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using core::Vec2;
using core::Vec3;
using ellipsoid_test::Configuration;
using ellipsoid_test::configurations;
using ellipsoid_test::draw_from;
using ellipsoid_test::facet_of;
using renderer::Facet;
using renderer::FocusPair;

TEST(EllipsoidalConnection, SegmentsHaveExactlyTheRequestedLength) {
    core::Rng rng(test_support::seed_of("LegsHaveExactly"), 0, 0);
    int drawn = 0;
    for (const Configuration& c : configurations("LegsHaveExactly")) {
        for (int i = 0; i < 400; ++i) {
            const auto draw = draw_from(c, rng);
            if (!draw) continue;
            ++drawn;
            const double length = c.foci.opl_m(draw->connection.position);
            EXPECT_NEAR(length / draw->opl_m, 1.0, 1e-12) << c.name;
        }
    }
    EXPECT_GT(drawn, 12000);
}

// Lengths a hair above the distance of the foci: the ellipsoid is a needle.
TEST(EllipsoidalConnection, LengthsAreExactOnNeedles) {
    core::Rng rng(test_support::seed_of("LengthsAreExactOnNeedles"), 0, 0);
    int drawn = 0;
    for (int i = 0; i < 4000; ++i) {
        const FocusPair foci{test_support::random_point(rng), test_support::random_point(rng)};
        const Vec3 middle = 0.5 * (foci.a + foci.b);
        const Vec3 arm1 = test_support::random_point(rng);
        const Vec3 arm2 = test_support::random_point(rng);
        const Facet facet = facet_of(middle + arm1, middle + arm2, middle - arm1 - arm2);
        const double opl_m =
            (foci.a - foci.b).norm() * (1.0 + std::pow(10.0, -1.0 - 12.0 * rng.uniform()));
        const auto connection = sample_ellipsoid(foci, opl_m, facet, rng.uniform());
        if (!connection) continue;
        ++drawn;
        EXPECT_NEAR(foci.opl_m(connection->position) / opl_m, 1.0, 1e-12);
    }
    EXPECT_GT(drawn, 3500);
}

TEST(EllipsoidalConnection, SamplesLieInTheTriangle) {
    core::Rng rng(test_support::seed_of("SamplesLieIn"), 0, 0);
    for (const Configuration& c : configurations("SamplesLieIn")) {
        for (int i = 0; i < 400; ++i) {
            const auto draw = draw_from(c, rng);
            if (!draw) continue;
            const Vec3& x = draw->connection.position;
            const Vec3 offset = x - c.facet.corner;
            EXPECT_LT(std::abs(c.facet.normal.dot(offset)), 1e-9) << c.name;
            const double twice = 2.0 * c.facet.area_m2;
            const double b1 = offset.cross(c.facet.edge2).dot(c.facet.normal) / twice;
            const double b2 = c.facet.edge1.cross(offset).dot(c.facet.normal) / twice;
            EXPECT_GT(std::min({b1, b2, 1.0 - b1 - b2}) * std::sqrt(twice), -1e-7) << c.name;
        }
    }
}

TEST(EllipsoidalConnection, InverseReturnsTheRandomNumber) {
    core::Rng rng(test_support::seed_of("InverseReturns"), 0, 0);
    int inverted = 0;
    for (const Configuration& c : configurations("InverseReturns")) {
        for (int i = 0; i < 200; ++i) {
            const auto draw = draw_from(c, rng);
            if (!draw) continue;
            const auto u =
                test_support::invert_ellipsoid(c.foci, c.facet, draw->connection.position);
            if (!u) continue;  // a length at the end of the band, rounded
            ++inverted;
            // u is a fraction of the arcs: where these are short, rounding of x is a larger
            // fraction.
            EXPECT_NEAR(*u, draw->u, c.name == "random" ? 1e-6 : 1e-3) << c.name;
        }
    }
    EXPECT_GT(inverted, 5000);
}

TEST(EllipsoidalConnection, DensityOfASampleIsThatOfThePoint) {
    core::Rng rng(test_support::seed_of("DensityOfASample"), 0, 0);
    for (const Configuration& c : configurations("DensityOfASample")) {
        if (c.name != "random" && c.name != "coincident" && c.name != "narrow") continue;
        for (int i = 0; i < 200; ++i) {
            const auto draw = draw_from(c, rng);
            if (!draw) continue;
            const double pdf = pdf_ellipsoid(c.foci, c.facet, draw->connection.position);
            EXPECT_NEAR(pdf / draw->connection.pdf_area_per_pdf_opl, 1.0, 1e-4) << c.name;
        }
    }
}

// Draws towards a lobe: their density is that of the point, integrates to 1 over the curve, and
// keeps them near the lobe.
TEST(EllipsoidalConnection, LobesDrawNearTheirMiddle) {
    core::Rng rng(test_support::seed_of("LobesDraw"), 0, 0);
    constexpr int kDraws = 2000;
    int near_lobe = 0;
    int near_without = 0;
    int curves = 0;
    for (const Configuration& c : configurations("LobesDraw")) {
        if (c.name != "random" && c.name != "coincident" && c.name != "narrow") continue;
        const Vec2 b = core::sample_triangle({rng.uniform(), rng.uniform()});
        const Vec3 aim = c.facet.point(b.x(), b.y());
        const double opl_m = c.foci.opl_m(aim);  // the curve passes the lobe's middle
        const renderer::ConnectionLobe lobe{(aim - c.foci.a).normalized(), aim, 0.02};
        if (!sample_ellipsoid(c.foci, opl_m, c.facet, 0.5)) continue;
        ++curves;
        double normalisation = 0.0;
        double squares = 0.0;
        for (int i = 0; i < kDraws; ++i) {
            const double u = (i + rng.uniform()) / kDraws;
            const auto turn_of = [&](const Vec3& x) {
                return std::acos(std::min(1.0, lobe.direction.dot((x - c.foci.a).normalized())));
            };
            const auto uniform = sample_ellipsoid(c.foci, opl_m, c.facet, u);
            const auto draw = sample_ellipsoid(c.foci, opl_m, c.facet, u, &lobe);
            ASSERT_TRUE(uniform && draw);
            near_without += turn_of(uniform->position) < 0.04 ? 1 : 0;
            near_lobe += turn_of(draw->position) < 0.04 ? 1 : 0;
            const double pdf = pdf_ellipsoid(c.foci, c.facet, draw->position, &lobe);
            EXPECT_NEAR(pdf / draw->pdf_area_per_pdf_opl, 1.0, 1e-3) << c.name;
            const double ratio =
                pdf_ellipsoid(c.foci, c.facet, draw->position) / draw->pdf_area_per_pdf_opl;
            normalisation += ratio / kDraws;
            squares += ratio * ratio / kDraws;
        }
        const double sigma = std::sqrt(std::max(0.0, squares - normalisation * normalisation));
        EXPECT_NEAR(normalisation, 1.0, 5.0 * sigma / std::sqrt(kDraws) + 1e-6) << c.name;
    }
    EXPECT_GT(curves, 15);
    // A Cauchy distribution has 0.70 of its mass within twice its width.
    EXPECT_GT(near_lobe, 0.6 * kDraws * curves);
    EXPECT_LT(near_without, 0.3 * kDraws * curves);
}

}  // namespace
