// SPDX-License-Identifier: MIT
#include "renderer/shift/shift_mapping.h"

#include "renderer/core/error.h"
#include "renderer/core/random.h"
#include "tests/support/error_message.h"
#include "tests/support/shift_cases.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::Vec3;
using renderer::Chart;
using renderer::Gauge;
using test_support::ShiftCase;

double length_of(const renderer::ShiftEnd& end, const Vec3& x) {
    return (end.a - x).norm() + (x - end.y).norm();
}

struct Variant {
    Chart chart;
    Gauge gauge;
    bool closed_form = false;

    renderer::ShiftSettings settings() const {
        renderer::ShiftSettings settings;
        settings.chart = chart;
        settings.gauge = gauge;
        settings.closed_form_on_planes = closed_form;
        return settings;
    }
};

void PrintTo(const Variant& v, std::ostream* out) {
    *out << core::enum_name(v.chart) << "_" << core::enum_name(v.gauge)
         << (v.closed_form ? "_closed_form" : "");
}

std::vector<Variant> all_variants() {
    std::vector<Variant> variants;
    for (const Chart chart : {Chart::Plane, Chart::Hemisphere, Chart::Barycentric}) {
        for (const auto& [gauge, name] : core::EnumNames<Gauge>::value) {
            variants.push_back({chart, gauge});
        }
    }
    variants.push_back({Chart::Plane, Gauge::Average, true});
    variants.push_back({Chart::Adaptive, Gauge::Average, true});
    return variants;
}

class ShiftMapping : public testing::TestWithParam<Variant> {
 protected:
    const Vec3 centre_ = Vec3::Zero();
    renderer::Scene scene_ = test_support::scene_of({test_support::tilted_quad(centre_, 1.0)});

    std::uint64_t seed() const { return test_support::seed_of(testing::PrintToString(GetParam())); }
};

TEST_P(ShiftMapping, JacobianMatchesCentralDifferences) {
    renderer::ShiftSettings settings = GetParam().settings();
    // What is not reversible has a determinant all the same.
    if (settings.gauge == Gauge::Start) settings.reverse_check = false;
    const renderer::ShiftMapping mapping(scene_, settings);
    const std::uint64_t cases = settings.gauge == Gauge::Flow ? 16 : 60;  // the flow is slow
    for (const double ratio : {0.2, 1.0, 5.0}) {
        int checked = 0;
        for (std::uint64_t i = 0; i < cases; ++i) {
            core::Rng rng(seed(), i, 0);
            test_support::ShiftCaseSettings draw;
            draw.ratio = ratio;
            draw.confocal = i % 3 == 0;
            const ShiftCase c = test_support::random_shift_case(scene_, centre_, draw, rng);
            renderer::ShiftCounts counts;
            const auto result = test_support::shift(mapping, c, counts);
            const auto coarse = test_support::jacobian_by_differences(scene_, mapping, c, 2e-4);
            const auto expected = test_support::jacobian_by_differences(scene_, mapping, c, 1e-4);
            if (!result || !coarse || !expected) continue;
            // Near a degenerate point the differences themselves have not converged.
            if (std::abs(*coarse / *expected - 1.0) > 1e-6) continue;
            EXPECT_NEAR(result->jacobian / *expected, 1.0, 1e-6)
                << "S = " << ratio << ", case " << i;
            ++checked;
        }
        EXPECT_GE(checked, int(cases) / 4) << "S = " << ratio;
    }
}

TEST_P(ShiftMapping, PathLengthChangesAsAsked) {
    const renderer::ShiftMapping mapping(scene_, GetParam().settings());
    for (std::uint64_t i = 0; i < 300; ++i) {
        core::Rng rng(seed(), i, 0);
        const ShiftCase c = test_support::random_shift_case(scene_, centre_, {}, rng);
        renderer::ShiftCounts counts;
        const auto result = test_support::shift(mapping, c, counts);
        if (!result) continue;
        const double wanted =
            c.change.ratio * length_of(c.source, c.x.position) + c.change.offset_m;
        EXPECT_NEAR(length_of(c.target, result->point.position), wanted, 1e-9);
    }
}

TEST_P(ShiftMapping, InverseShiftReturnsTheSourcePath) {
    const Gauge gauge = GetParam().gauge;
    if (gauge == Gauge::Start) GTEST_SKIP() << "not reversible";
    const double tolerance = gauge == Gauge::Flow ? 1e-8 : 1e-10;
    const renderer::ShiftMapping mapping(scene_, GetParam().settings());
    int checked = 0;
    for (const double ratio : {0.2, 1.0, 5.0}) {
        for (std::uint64_t i = 0; i < 100; ++i) {
            core::Rng rng(seed(), i, 1);
            test_support::ShiftCaseSettings draw;
            draw.ratio = ratio;
            draw.offset_m = 0.1;
            const ShiftCase c = test_support::random_shift_case(scene_, centre_, draw, rng);
            renderer::ShiftCounts counts;
            const auto there = test_support::shift(mapping, c, counts);
            if (!there) continue;
            const auto back = test_support::shift(mapping, c.inverse(there->point), counts);
            ASSERT_TRUE(back) << "S = " << ratio << ", case " << i;
            EXPECT_LE((back->point.position - c.x.position).norm(), tolerance);
            EXPECT_NEAR(there->jacobian * back->jacobian, 1.0, tolerance);
            ++checked;
        }
    }
    EXPECT_GE(checked, 100);
}

TEST_P(ShiftMapping, JacobianOfPathVelocitiesMatchesCentralDifferences) {
    const renderer::ShiftMapping mapping(
        scene_, GetParam().settings(), renderer::ShiftQuantity::PathVelocity);
    int checked = 0;
    for (std::uint64_t i = 0; i < 60; ++i) {
        core::Rng rng(seed(), i, 2);
        test_support::ShiftCaseSettings draw;
        draw.velocity_m_per_s = 1.0;
        ShiftCase c = test_support::random_shift_case(scene_, centre_, draw, rng);
        // As gates move, so do bins of path velocity: here to where the target's already is,
        // nearly.
        c.target.velocity_a = c.source.velocity_a + 0.02 * test_support::random_direction(rng);
        c.target.velocity_y = c.source.velocity_y + 0.02 * test_support::random_direction(rng);
        c.change.offset_m *= 0.2;
        renderer::ShiftCounts counts;
        const auto result = test_support::shift(mapping, c, counts);
        const auto coarse = test_support::jacobian_by_differences(scene_, mapping, c, 2e-4);
        const auto expected = test_support::jacobian_by_differences(scene_, mapping, c, 1e-4);
        if (!result || !coarse || !expected) continue;
        if (std::abs(*coarse / *expected - 1.0) > 1e-6) continue;
        EXPECT_NEAR(result->jacobian / *expected, 1.0, 1e-6) << "case " << i;
        const auto velocity_at = [](const renderer::ShiftEnd& end, const Vec3& x) {
            return (end.a - x).normalized().dot(end.velocity_a) +
                   (end.y - x).normalized().dot(end.velocity_y);
        };
        EXPECT_NEAR(velocity_at(c.target, result->point.position),
                    velocity_at(c.source, c.x.position) + c.change.offset_m,
                    1e-8);
        ++checked;
    }
    if (GetParam().gauge == Gauge::Start) return;  // hardly any passes the reverse check
    EXPECT_GE(checked, 15);
}

INSTANTIATE_TEST_SUITE_P(All,
                         ShiftMapping,
                         testing::ValuesIn(all_variants()),
                         testing::PrintToStringParamName());

// A sheet of small facets in front of a large quad.
class ShiftMappingOnMesh : public testing::TestWithParam<Variant> {
 protected:
    const Vec3 centre_ = Vec3::Zero();
    renderer::Scene scene_ =
        test_support::scene_of({test_support::tilted_quad(centre_, 1.0),
                                test_support::wavy_sheet({0.3, 0.2, -0.2}, 0.5, 24, 0.05)});
};

TEST_P(ShiftMappingOnMesh, InverseShiftReturnsTheSourcePath) {
    const renderer::ShiftMapping mapping(scene_, GetParam().settings());
    renderer::ShiftCounts there_counts;
    renderer::ShiftCounts back_counts;
    for (std::uint64_t i = 0; i < 4000; ++i) {
        core::Rng rng(test_support::seed_of("ShiftMappingOnMesh"), i, 0);
        test_support::ShiftCaseSettings draw;
        draw.ratio = i % 2 == 0 ? 1.0 : std::exp(rng.uniform() - 0.5);
        draw.confocal = i % 3 == 0;
        const ShiftCase c = test_support::random_shift_case(scene_, centre_, draw, rng);
        // What starts behind the sheet is no path.
        const Vec3& normal = scene_.facet(c.x.facet).normal;
        if (scene_.rays().is_blocked(c.source.y, c.source.normal_y, c.x.position, normal)) continue;
        const auto there = test_support::shift(mapping, c, there_counts);
        if (!there) continue;
        const auto back = test_support::shift(mapping, c.inverse(there->point), back_counts);
        ASSERT_TRUE(back) << "case " << i;
        EXPECT_LE((back->point.position - c.x.position).norm(), 1e-9) << "case " << i;
        EXPECT_EQ(back->point.facet, c.x.facet);
        EXPECT_NEAR(there->jacobian * back->jacobian, 1.0, 1e-8) << "case " << i;
    }
    EXPECT_EQ(there_counts.by_ray, back_counts.by_ray);
    EXPECT_GE(there_counts.accepted, 300U);
}

INSTANTIATE_TEST_SUITE_P(Charts,
                         ShiftMappingOnMesh,
                         testing::Values(Variant{Chart::Plane, Gauge::Average},
                                         Variant{Chart::Barycentric, Gauge::Average},
                                         Variant{Chart::Hemisphere, Gauge::Average},
                                         Variant{Chart::Hemisphere, Gauge::Midpoint},
                                         Variant{Chart::Adaptive, Gauge::Average},
                                         Variant{Chart::Adaptive, Gauge::Average, true}),
                         testing::PrintToStringParamName());

TEST(ShiftMappingSettings, CustomChartNeedsCode) {
    const renderer::Scene scene =
        test_support::scene_of({test_support::tilted_quad(Vec3::Zero(), 1.0)});
    renderer::ShiftSettings settings;
    settings.chart = Chart::Custom;
    EXPECT_ERROR_WITH(renderer::ShiftMapping(scene, settings),
                      "must be plane, hemisphere, barycentric or adaptive");
}

}  // namespace
