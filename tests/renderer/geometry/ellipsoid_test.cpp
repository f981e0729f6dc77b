// SPDX-License-Identifier: MIT
// Laws of the ellipsoidal connection, on random and on degenerate foci, lengths and triangles.
#include "renderer/geometry/ellipsoid.h"

#include "renderer/core/random.h"
#include "renderer/core/sampling.h"
#include "tests/support/inverse_sampling.h"
#include "tests/support/random_geometry.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::kPi;
using core::Vec2;
using core::Vec3;
using renderer::Facet;
using renderer::FocusPair;
using renderer::OplBand;

// Foci, a triangle and an interval of lengths.
struct Configuration {
    std::string name;
    FocusPair foci;
    Facet facet;
    OplBand lengths;
};

// The interval between two shares of the facet's band.
OplBand part_of_band(const FocusPair& foci, const Facet& facet, double from, double to) {
    const OplBand band = opl_band(foci, facet);
    return {band.low_m + from * band.width_m(), band.low_m + to * band.width_m()};
}

Configuration make(const std::string& name, const FocusPair& foci, const Facet& facet) {
    return {name, foci, facet, part_of_band(foci, facet, 0.0, 1.0)};
}

Facet facet_of(const Vec3& a, const Vec3& b, const Vec3& c) {
    return test_support::make_facet(a, b, c);
}

std::vector<Configuration> configurations(const std::string& test) {
    core::Rng rng(test_support::seed_of(test), 0, 0);
    const auto point = [&] { return test_support::random_point(rng); };
    const auto facet = [&] { return facet_of(point(), point(), point()); };
    std::vector<Configuration> all;
    for (int i = 0; i < 8; ++i) {
        const FocusPair foci{point(), point()};
        const Facet random = facet();
        all.push_back(make("random", foci, random));
        all.push_back({"narrow", foci, random, part_of_band(foci, random, 0.4, 0.45)});
        const Vec3 a = point();
        all.push_back(make("coincident", {a, a}, random));
        const double apart = std::pow(10.0, -3.0 - 1.5 * i);
        all.push_back(make("near coincident", {a, a + apart * Vec3(0.3, -0.5, 0.8)}, random));
        // The shortest length of a triangle around the foot of the foci: a tangent plane.
        const Facet under = facet_of(
            a + Vec3(-1.0, -0.8, -0.5), a + Vec3(1.2, -0.7, -0.5), a + Vec3(0.1, 1.1, -0.5));
        all.push_back({"tangent",
                       {a, a + Vec3(0.2, 0.1, 0.0)},
                       under,
                       part_of_band({a, a + Vec3(0.2, 0.1, 0.0)}, under, 0.0, 0.05)});
        // A triangle across the segment between the foci: lengths down to their distance.
        const Vec3 middle = 0.5 * (foci.a + foci.b);
        const Vec3 arm1 = 0.4 * point();
        const Vec3 arm2 = 0.4 * point();
        const double distance = (foci.a - foci.b).norm();
        all.push_back({"at the foci's distance",
                       foci,
                       facet_of(middle + arm1, middle + arm2, middle - arm1 - arm2),
                       {distance, distance * (1.0 + std::pow(10.0, -1.0 - 0.15 * i))}});
        const Vec3 corner = point();
        const Vec3 along = point() - corner;
        all.push_back(
            make("sliver",
                 foci,
                 facet_of(corner,
                          corner + along,
                          corner + 0.4 * along + std::pow(10.0, -1.0 - 0.5 * i) * point())));
        // A plane that holds both foci.
        all.push_back(
            make("in the plane", {random.point(0.2, 0.9), random.point(-0.4, 0.3)}, random));
    }
    return all;
}

struct Draw {
    double opl_m = 0.0;
    double u = 0.0;
    renderer::EllipsoidalConnection connection;
};

std::optional<Draw> draw_from(const Configuration& c, core::Rng& rng) {
    Draw draw;
    draw.opl_m = c.lengths.low_m + rng.uniform() * c.lengths.width_m();
    draw.u = rng.uniform();
    const auto connection = sample_ellipsoid(c.foci, draw.opl_m, c.facet, draw.u);
    if (!connection) return std::nullopt;
    draw.connection = *connection;
    return draw;
}

TEST(EllipsoidalConnection, LegsHaveExactlyTheRequestedLength) {
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
            // u is a share of the arcs: where these are short, rounding of x is a larger share.
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

// The point as a function of (length, angle), by central differences.
TEST(EllipsoidSection, AreaElementMatchesFiniteDifferences) {
    core::Rng rng(test_support::seed_of("AreaElement"), 0, 0);
    int compared = 0;
    for (const Configuration& c : configurations("AreaElement")) {
        for (int i = 0; i < 20; ++i) {
            const double opl_m =
                c.lengths.low_m + (0.1 + 0.8 * rng.uniform()) * c.lengths.width_m();
            const double angle = 2.0 * kPi * rng.uniform();
            const double step = 1e-5;
            const auto point = [&](double length, double theta) -> std::optional<Vec3> {
                const auto section = renderer::EllipsoidSection::cut(c.foci, length, c.facet);
                if (!section) return std::nullopt;
                return section->point({std::cos(theta), std::sin(theta)});
            };
            const double length_step = step * c.lengths.width_m();
            const auto longer = point(opl_m + length_step, angle);
            const auto shorter = point(opl_m - length_step, angle);
            const auto section = renderer::EllipsoidSection::cut(c.foci, opl_m, c.facet);
            if (!longer || !shorter || !section) continue;
            const Vec3 d_angle = (*point(opl_m, angle + step) - *point(opl_m, angle - step)) / step;
            const Vec3 d_length = (*longer - *shorter) / length_step;
            const double expected = 0.25 * d_angle.cross(d_length).norm();
            const Vec2 unit(std::cos(angle), std::sin(angle));
            const double found = section->area_per_opl_and_angle(section->point(unit), unit);
            ++compared;
            EXPECT_NEAR(found / expected, 1.0, 2e-4) << c.name << " " << opl_m;
        }
    }
    EXPECT_GT(compared, 700);
}

TEST(EllipsoidSection, CoincidentFociGiveHalfTheRadius) {
    core::Rng rng(test_support::seed_of("CoincidentFoci"), 0, 0);
    const Vec3 a(0.1, -0.2, 0.3);
    const Facet facet = facet_of(Vec3(-1, -1, 1), Vec3(2, -1, 1.2), Vec3(0, 2, 1.1));
    for (const double apart : {0.0, 1e-15, 1e-12, 1e-9, 1e-6}) {
        const FocusPair foci{a, a + apart * Vec3(0.6, 0.0, 0.8)};
        const auto section = renderer::EllipsoidSection::cut(foci, 2.6, facet);
        ASSERT_TRUE(section);
        for (int i = 0; i < 20; ++i) {
            const double angle = 2.0 * kPi * rng.uniform();
            const Vec2 unit(std::cos(angle), std::sin(angle));
            EXPECT_NEAR(section->area_per_opl_and_angle(section->point(unit), unit),
                        0.65,
                        1e-12 + 2.0 * apart);
        }
    }
}

// Where the ellipsoid touches the plane, the area within length tau grows as 2 pi / sqrt(det H)
// times tau, H the length's Hessian in the plane; so do all angles together.
TEST(EllipsoidSection, AreaElementIsFiniteAtTheFirstArrival) {
    const FocusPair foci{Vec3(-0.3, 0.0, 0.0), Vec3(0.3, 0.0, 0.0)};
    const Facet facet = facet_of(Vec3(-5, -5, 0.4), Vec3(5, -5, 0.4), Vec3(0, 5, 0.4));
    const double first = 1.0;  // twice the hypotenuse of 0.3 and 0.4
    // Hess l = sum (I - u u^T)/d, u = (+-0.6, 0, -0.8), d = 0.5: diag(2 * 0.64/0.5, 2/0.5).
    const double expected = 2.0 * kPi / std::sqrt(2.0 * 0.64 / 0.5 * 2.0 / 0.5);
    for (const double beyond : {1e-4, 1e-7, 1e-10, 1e-13}) {
        const auto section = renderer::EllipsoidSection::cut(foci, first + beyond, facet);
        ASSERT_TRUE(section) << beyond;
        double sum = 0.0;
        for (int i = 0; i < 64; ++i) {
            const double angle = 2.0 * kPi * (i + 0.5) / 64;
            const Vec2 unit(std::cos(angle), std::sin(angle));
            sum += section->area_per_opl_and_angle(section->point(unit), unit) * 2.0 * kPi / 64;
        }
        EXPECT_NEAR(sum / expected, 1.0, 1e-3) << beyond;
    }
}

TEST(EllipsoidSection, AngleIsKeptBetweenFoci) {
    const Facet facet = facet_of(Vec3(-1, -1, 1), Vec3(2, -1, 1.2), Vec3(0, 2, 1.1));
    const FocusPair foci{Vec3(0, 0, 0), Vec3(0.3, 0.1, 0)};
    for (const double shift : {1e-3, 1e-6}) {
        const FocusPair moved{foci.a + shift * Vec3(1, 0, 0), foci.b + shift * Vec3(0, 1, 0)};
        const auto before = renderer::EllipsoidSection::cut(foci, 3.0, facet);
        const auto after = renderer::EllipsoidSection::cut(moved, 3.0 + shift, facet);
        for (int i = 0; i < 8; ++i) {
            const Vec2 angle(std::cos(i), std::sin(i));
            EXPECT_LT((before->point(angle) - after->point(angle)).norm(), 5.0 * shift);
            EXPECT_LT((after->angle_of(after->point(angle)) - angle).norm(), 1e-12);
        }
    }
}

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
// triangle at the share t of the way from corner k, t uniform, which has the area density 1/(2 A
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
