// SPDX-License-Identifier: MIT
// The section of an ellipsoid and a plane: its points and its area element.
#include "renderer/core/random.h"
#include "renderer/geometry/ellipsoid.h"
#include "tests/renderer/geometry/ellipsoid_configurations.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace {

using core::kPi;
using core::Vec2;
using core::Vec3;
using ellipsoid_test::Configuration;
using ellipsoid_test::configurations;
using ellipsoid_test::facet_of;
using renderer::Facet;
using renderer::FocusPair;

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

}  // namespace
