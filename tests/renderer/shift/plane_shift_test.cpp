// SPDX-License-Identifier: MIT
#include "renderer/shift/plane_shift.h"

#include "renderer/core/random.h"
#include "renderer/shift/charts.h"
#include "renderer/shift/path_functional.h"
#include "renderer/shift/shift_flow.h"
#include "renderer/shift/shift_solver.h"
#include "tests/support/shift_cases.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

namespace {

using core::Vec2;
using core::Vec3;
using renderer::ConstraintChange;
using renderer::FocusPair;
using renderer::ShiftTrace;

renderer::Facet plane_z0() {
    renderer::Facet plane;
    plane.corner.setZero();
    plane.edge1 = Vec3::UnitX();
    plane.edge2 = Vec3::UnitY();
    plane.normal = Vec3::UnitZ();
    return plane;
}

TEST(PlaneShift, ConfocalJacobianIsTheRatioOfRadii) {
    for (std::uint64_t i = 0; i < 200; ++i) {
        core::Rng rng(test_support::seed_of("ConfocalPlane"), i, 0);
        const Vec3 focus(rng.uniform(), rng.uniform(), 0.5 + rng.uniform());
        const Vec3 moved = focus + 0.05 * test_support::random_direction(rng);
        const double ratio = std::exp(3.0 * (rng.uniform() - 0.5));
        const double radius = focus.norm();
        const double new_radius = moved.norm() * (1.0 + 0.2 * rng.uniform());
        ShiftTrace trace;
        const auto shift = shift_on_plane(plane_z0(),
                                          {focus, focus},
                                          {moved, moved},
                                          {ratio, 2.0 * (new_radius - ratio * radius)},
                                          0.0,
                                          trace);
        ASSERT_TRUE(shift);
        EXPECT_NEAR((moved - shift->displacement).norm(), new_radius, 1e-12);
        EXPECT_NEAR(shift->jacobian, ratio * new_radius / radius, 1e-10);
    }
}

TEST(PlaneShift, ScalesWithTheScene) {
    const auto shift_of = [](double scale) {
        const FocusPair source{scale * Vec3(-3, 1, 1), scale * Vec3(5, 1, 1)};
        const FocusPair target{scale * Vec3(-3, 1, 1.1), scale * Vec3(5, 1.1, 1)};
        ShiftTrace trace;
        return shift_on_plane(plane_z0(), source, target, {1.0, 0.2 * scale}, 0.0, trace);
    };
    const auto unscaled = shift_of(1.0);
    ASSERT_TRUE(unscaled);
    for (const double scale : {0.01, 0.3, 7.0, 100.0}) {
        const auto shift = shift_of(scale);
        ASSERT_TRUE(shift) << scale;
        EXPECT_NEAR((shift->displacement / scale - unscaled->displacement).norm(), 0.0, 1e-12);
        EXPECT_NEAR(shift->jacobian, unscaled->jacobian, 1e-10);
    }
}

// Around coincident foci that stay in place every gradient in the plane points away from the foot
// of the perpendicular, so all gauges move along the same line, and the closed form is an oracle.
template <class Gauge>
class PlaneShiftOracle : public testing::Test {};
using PlaneGauges = testing::Types<renderer::AverageGauge,
                                   renderer::MetricAverageGauge,
                                   renderer::StartGauge,
                                   renderer::MidpointGauge,
                                   renderer::SymmetricGauge,
                                   renderer::FlowGauge>;
TYPED_TEST_SUITE(PlaneShiftOracle, PlaneGauges);

TYPED_TEST(PlaneShiftOracle, EveryGaugeMovesLikeTheClosedFormAroundOneFocus) {
    // The start gauge moves like the others here, but its determinant is its own.
    const bool compares_jacobian = !std::is_same_v<TypeParam, renderer::StartGauge>;
    const renderer::AffineChart chart(
        Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::Zero(), 0.0);
    for (std::uint64_t i = 0; i < 50; ++i) {
        core::Rng rng(test_support::seed_of("OneFocus"), i, 0);
        const Vec3 focus(0.5 + rng.uniform(), rng.uniform(), 0.3 + rng.uniform());
        for (const double ratio : {0.2, 1.0, 5.0}) {
            const double length = 2.0 * focus.norm();
            const ConstraintChange change{
                ratio, (1.0 - ratio) * length + 0.1 * (2.0 * rng.uniform() - 1.0)};
            ShiftTrace trace;
            const auto expected =
                shift_on_plane(plane_z0(), {focus, focus}, {focus, focus}, change, 0.0, trace);
            const renderer::OpticalLength functional{focus, focus};
            const renderer::ShiftSide source{chart, functional, ratio};
            const renderer::ShiftSide target{chart, functional, 1.0};
            const auto found =
                shift_on_charts(TypeParam{},
                                renderer::ShiftProblem{source, target, change.offset_m},
                                Vec2::Zero(),
                                *source.at(Vec2::Zero()),
                                renderer::ReverseCheck::Off,
                                trace);
            ASSERT_TRUE(expected && found) << "case " << i << ", S = " << ratio;
            EXPECT_LE((found->at_target.position - expected->displacement).norm(), 1e-9);
            if (compares_jacobian) {
                EXPECT_NEAR(found->jacobian / expected->jacobian, 1.0, 1e-7);
            }
        }
    }
}

TEST(PlaneShift, RejectsLengthsBelowTheMirroredPath) {
    const FocusPair foci{Vec3(-0.3, 0.1, 0.5), Vec3(0.4, 0.0, 0.9)};
    const double shortest = (foci.a - Vec3(0.4, 0.0, -0.9)).norm();
    const double length = foci.a.norm() + foci.b.norm();
    ShiftTrace trace;
    EXPECT_FALSE(
        shift_on_plane(plane_z0(), foci, foci, {1.0, shortest - 1e-6 - length}, 0.0, trace));
    EXPECT_EQ(trace.rejection, renderer::ShiftRejection::BelowMinimum);
    EXPECT_TRUE(
        shift_on_plane(plane_z0(), foci, foci, {1.0, shortest + 1e-6 - length}, 0.0, trace));
}

}  // namespace
