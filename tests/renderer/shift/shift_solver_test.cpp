// SPDX-License-Identifier: MIT
#include "renderer/shift/shift_solver.h"

#include "renderer/core/random.h"
#include "renderer/shift/charts.h"
#include "renderer/shift/path_functional.h"
#include "renderer/shift/shift_flow.h"
#include "tests/support/sdf_chart.h"
#include "tests/support/shift_cases.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

namespace {

using core::Vec2;
using core::Vec3;
using renderer::ReverseCheck;
using renderer::ShiftSide;
using renderer::ShiftTrace;

// A shift between two pairs of foci in one chart.
template <class Chart, class Functional>
struct Setup {
    ShiftSide<Chart, Functional> source;
    ShiftSide<Chart, Functional> target;
    double change;
    Vec2 xi;

    renderer::ShiftProblem<decltype(source), decltype(target)> problem() const {
        return {source, target, change};
    }

    template <class Gauge>
    std::optional<renderer::ShiftSolution> solve(const Gauge& gauge,
                                                 const Vec2& from,
                                                 ReverseCheck check) const {
        const auto at_source = source.at(from);
        ShiftTrace trace;
        if (!at_source) return std::nullopt;
        return shift_on_charts(gauge, problem(), from, *at_source, check, trace);
    }

    // |dxi'/dxi| by differences, times the ratio of area densities.
    template <class Gauge>
    std::optional<double> jacobian_by_differences(const Gauge& gauge, double h) const {
        const auto centre = solve(gauge, xi, ReverseCheck::Off);
        if (!centre) return std::nullopt;
        Eigen::Matrix2d derivative;
        for (int k = 0; k < 2; ++k) {
            std::array<Vec2, 4> ends;
            for (std::size_t i = 0; i < 4; ++i) {
                const double steps = std::array{-2.0, -1.0, 1.0, 2.0}[i];
                const auto end = solve(gauge, xi + steps * h * Vec2::Unit(k), ReverseCheck::Off);
                if (!end) return std::nullopt;
                ends[i] = end->xi;
            }
            derivative.col(k) = (8.0 * (ends[2] - ends[1]) - (ends[3] - ends[0])) / (12.0 * h);
        }
        return std::abs(derivative.determinant()) * centre->at_target.metric.area_density /
               source.at(xi)->metric.area_density;
    }
};

const test_support::SmoothSpheres kSurface{
    {{Vec3(0.0, 0.0, 0.0), 0.5}, {Vec3(0.45, 0.2, 0.1), 0.3}, {Vec3(-0.3, 0.4, 0.05), 0.35}}, 0.1};

using SdfSetup = Setup<test_support::SdfChart, renderer::OpticalLength>;

SdfSetup sdf_setup(core::Rng& rng, double ratio, double moved_m) {
    const test_support::SdfChart chart(kSurface, core::Mat3::Identity(), 1.5);
    const auto around = [&](const Vec3& p, double r) {
        return Vec3(p + r * rng.uniform() * test_support::random_direction(rng));
    };
    const renderer::OpticalLength source{around({0, 0, 2}, 0.8), around({0.3, 0, 2}, 0.8)};
    const renderer::OpticalLength target{around(source.focus_a, moved_m),
                                         around(source.focus_y, moved_m)};
    const Vec2 xi(0.6 * (rng.uniform() - 0.5), 0.6 * (rng.uniform() - 0.5));
    SdfSetup setup{{chart, source, ratio}, {chart, target, 1.0}, 0.0, xi};
    const double length = setup.source.at(xi)->value / ratio;
    setup.change = (1.0 - ratio) * length + 0.02 * (2.0 * rng.uniform() - 1.0);
    return setup;
}

template <class Gauge>
class ShiftSolver : public testing::Test {};
using SolverGauges = testing::Types<renderer::AverageGauge,
                                    renderer::MetricAverageGauge,
                                    renderer::StartGauge,
                                    renderer::FixedGauge,
                                    renderer::MidpointGauge,
                                    renderer::SymmetricGauge,
                                    renderer::FlowGauge>;
TYPED_TEST_SUITE(ShiftSolver, SolverGauges);

TYPED_TEST(ShiftSolver, JacobianOnAnImplicitSurfaceMatchesCentralDifferences) {
    const TypeParam gauge;
    for (const double ratio : {0.2, 1.0, 5.0}) {
        int checked = 0;
        // The flow takes hundreds of steps on a surface that is slow to find.
        const int cases = std::is_same_v<TypeParam, renderer::FlowGauge> ? 4 : 40;
        for (std::uint64_t i = 0; i < std::uint64_t(cases); ++i) {
            core::Rng rng(test_support::seed_of("ImplicitSurface"), i, 0);
            const SdfSetup setup = sdf_setup(rng, ratio, 0.03);
            const auto solution = setup.solve(gauge, setup.xi, ReverseCheck::Off);
            const auto coarse = setup.jacobian_by_differences(gauge, 2e-4);
            const auto expected = setup.jacobian_by_differences(gauge, 1e-4);
            if (!solution || !coarse || !expected) continue;
            if (std::abs(*coarse / *expected - 1.0) > 1e-6) continue;
            EXPECT_NEAR(solution->jacobian / *expected, 1.0, 1e-6)
                << "S = " << ratio << ", case " << i;
            ++checked;
        }
        EXPECT_GE(checked, cases * 3 / 8) << "S = " << ratio;
    }
}

TYPED_TEST(ShiftSolver, InverseShiftOnAnImplicitSurfaceReturnsTheSourcePath) {
    if (std::is_same_v<TypeParam, renderer::StartGauge>) GTEST_SKIP() << "not reversible";
    const TypeParam gauge;
    const double tolerance = std::is_same_v<TypeParam, renderer::FlowGauge> ? 1e-8 : 1e-10;
    int checked = 0;
    for (std::uint64_t i = 0; i < 60; ++i) {
        core::Rng rng(test_support::seed_of("ImplicitRoundTrip"), i, 0);
        const SdfSetup there = sdf_setup(rng, 1.0, 0.05);
        const auto solution = there.solve(gauge, there.xi, ReverseCheck::On);
        if (!solution) continue;
        const SdfSetup back{there.target, there.source, -there.change, solution->xi};
        const auto returned = back.solve(gauge, back.xi, ReverseCheck::On);
        ASSERT_TRUE(returned);
        EXPECT_LE((returned->xi - there.xi).norm(), tolerance);
        EXPECT_NEAR(solution->jacobian * returned->jacobian, 1.0, tolerance);
        ++checked;
    }
    EXPECT_GE(checked, 30);
}

using PlaneSetup = Setup<renderer::AffineChart, renderer::OpticalLength>;

// The plane z = 0 below two pairs of foci.
PlaneSetup plane_setup(core::Rng& rng, double moved_m, double offset_m) {
    const renderer::AffineChart chart(
        Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::Zero(), 0.0);
    const auto above = [&] {
        const double x = rng.uniform() - 0.5;
        const double y = rng.uniform() - 0.5;
        return Vec3(x, y, 0.6 + rng.uniform());
    };
    const renderer::OpticalLength source{above(), above()};
    const auto moved = [&](const Vec3& p) {
        return Vec3(p + moved_m * test_support::random_direction(rng));
    };
    const renderer::OpticalLength target{moved(source.focus_a), moved(source.focus_y)};
    const double x = 2.0 * (rng.uniform() - 0.5);
    return {{chart, source, 1.0}, {chart, target, 1.0}, offset_m, {x, 2.0 * (rng.uniform() - 0.5)}};
}

// Fraction of shifts whose way back ends elsewhere, and the middle of how far.
struct Irreversibility {
    double median_m;
    double fraction;
};

template <class Gauge>
Irreversibility irreversibility_of(const Gauge& gauge) {
    std::vector<double> distances;
    for (std::uint64_t i = 0; i < 400; ++i) {
        core::Rng rng(test_support::seed_of("Irreversibility"), i, 0);
        const double offset = 0.1 * (2.0 * rng.uniform() - 1.0);
        const PlaneSetup there = plane_setup(rng, 0.05, offset);
        const auto solution = there.solve(gauge, there.xi, ReverseCheck::Off);
        if (!solution) continue;
        const PlaneSetup back{there.target, there.source, -offset, solution->xi};
        const auto returned = back.solve(gauge, back.xi, ReverseCheck::Off);
        if (returned) distances.push_back((returned->xi - there.xi).norm());
    }
    std::sort(distances.begin(), distances.end());
    const auto far = std::upper_bound(distances.begin(), distances.end(), 1e-6);
    return {distances[distances.size() / 2],
            double(distances.end() - far) / double(distances.size())};
}

TEST(ShiftSolver, StartGradientIsNotReversible) {
    const Irreversibility start = irreversibility_of(renderer::StartGauge{});
    EXPECT_GE(start.median_m, 1e-4);
    EXPECT_GE(start.fraction, 0.95);
    EXPECT_LE(irreversibility_of(renderer::AverageGauge{}).median_m, 1e-12);
    EXPECT_LE(irreversibility_of(renderer::AverageGauge{}).fraction, 0.02);
}

TEST(ShiftSolver, ReverseCheckTakesNothingThatDoesNotComeBack) {
    int accepted = 0;
    for (std::uint64_t i = 0; i < 400; ++i) {
        core::Rng rng(test_support::seed_of("ReverseCheck"), i, 0);
        const double offset = 0.1 * (2.0 * rng.uniform() - 1.0);
        const PlaneSetup there = plane_setup(rng, 0.05, offset);
        accepted += there.solve(renderer::StartGauge{}, there.xi, ReverseCheck::On) ? 1 : 0;
    }
    EXPECT_LE(accepted, 8);
}

TEST(ShiftSolver, FlowConvergesAtFourthOrder) {
    int checked = 0;
    for (std::uint64_t i = 0; i < 60; ++i) {
        core::Rng rng(test_support::seed_of("FlowOrder"), i, 0);
        const PlaneSetup setup = plane_setup(rng, 0.1, 0.2);
        ShiftTrace trace;
        const auto flow = [&](int steps) {
            return follow_flow(setup.problem(), setup.xi, *setup.source.at(setup.xi), steps, trace);
        };
        const auto exact = flow(1024);
        const auto coarse = flow(16);
        const auto fine = flow(32);
        if (!exact || !coarse || !fine) continue;
        const double end_coarse = (coarse->xi - exact->xi).norm();
        const double end_fine = (fine->xi - exact->xi).norm();
        const double det_coarse = std::abs(coarse->jacobian - exact->jacobian);
        const double det_fine = std::abs(fine->jacobian - exact->jacobian);
        // Between rounding and steps too long for any order to show.
        if (end_fine < 1e-11 || det_fine < 1e-11 || end_coarse > 1e-5) continue;
        EXPECT_NEAR(std::log2(end_coarse / end_fine), 4.0, 0.4) << "case " << i;
        EXPECT_NEAR(std::log2(det_coarse / det_fine), 4.0, 0.6) << "case " << i;
        ++checked;
    }
    EXPECT_GE(checked, 5);
}

TEST(ShiftSolver, SymmetricGaugeFollowsTheFlowToHigherOrder) {
    // Halving the whole shift divides a rule's local error by 2^(order + 1).
    int checked = 0;
    double sum_average = 0.0;
    double sum_symmetric = 0.0;
    for (std::uint64_t i = 0; i < 40; ++i) {
        const auto error_of = [&](const auto& gauge, double scale) -> std::optional<double> {
            core::Rng rng(test_support::seed_of("SymmetricOrder"), i, 0);
            const PlaneSetup setup = plane_setup(rng, 0.2 * scale, 0.2 * scale);
            const auto flow = setup.solve(renderer::FlowGauge{}, setup.xi, ReverseCheck::Off);
            const auto solution = setup.solve(gauge, setup.xi, ReverseCheck::Off);
            if (!flow || !solution) return std::nullopt;
            return (flow->xi - solution->xi).norm();
        };
        const auto average1 = error_of(renderer::AverageGauge{}, 1.0);
        const auto average2 = error_of(renderer::AverageGauge{}, 0.5);
        const auto symmetric1 = error_of(renderer::SymmetricGauge{}, 1.0);
        const auto symmetric2 = error_of(renderer::SymmetricGauge{}, 0.5);
        if (!average1 || !average2 || !symmetric1 || !symmetric2 || *symmetric2 < 1e-9) continue;
        sum_average += std::log2(*average1 / *average2);
        sum_symmetric += std::log2(*symmetric1 / *symmetric2);
        ++checked;
    }
    ASSERT_GE(checked, 10);
    EXPECT_GE(sum_symmetric / checked, sum_average / checked + 1.2);
}

TEST(ShiftSolver, BarycentricWithItsMetricMovesLikeThePlane) {
    for (std::uint64_t i = 0; i < 50; ++i) {
        core::Rng rng(test_support::seed_of("BarycentricMetric"), i, 0);
        const PlaneSetup plane = plane_setup(rng, 0.02, 0.02);
        const renderer::AffineChart skew(
            Vec3::Zero(), Vec3(0.7, 0.2, 0.0), Vec3(0.3, 1.9, 0.0), Vec3::Zero(), 0.0);
        Eigen::Matrix2d plane_from_skew;
        plane_from_skew << 0.7, 0.3, 0.2, 1.9;
        const PlaneSetup skewed{{skew, plane.source.functional, 1.0},
                                {skew, plane.target.functional, 1.0},
                                plane.change,
                                plane_from_skew.inverse() * plane.xi};
        const auto expected = plane.solve(renderer::AverageGauge{}, plane.xi, ReverseCheck::On);
        const auto found =
            skewed.solve(renderer::MetricAverageGauge{}, skewed.xi, ReverseCheck::On);
        ASSERT_EQ(bool(found), bool(expected));
        if (!found) continue;
        EXPECT_LE((plane_from_skew * found->xi - expected->xi).norm(), 1e-10);
        EXPECT_NEAR(found->jacobian, expected->jacobian, 1e-10);
    }
}

}  // namespace
