// SPDX-License-Identifier: MIT
// What wall points see of elements: rays in packets against single ones, draws of parts, and many
// points at once against one after the other.
#include "renderer/third_bounce/third_bounce_visibility.h"

#include "renderer/core/random.h"
#include "renderer/third_bounce/third_bounce_scan.h"
#include "tests/support/single_cut.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numeric>
#include <optional>

namespace {

using core::Vec3;
using renderer::ElementBlock;
using renderer::PointMask;
using renderer::ShadowRays;
using renderer::VisibilityMask;
using renderer::WallPoint;
using renderer::WallPointLanes;

// A ball and a screen before a sheet, on a wall that bends a little.
struct HalfHiddenSheet {
    core::WallScan scan = [] {
        std::vector<Vec3> points;
        for (int i = 0; i < 40; ++i) {
            points.emplace_back(-0.4 + 0.1 * (i % 8), -0.4 + 0.1 * (i / 8), 0.002 * (i % 5));
        }
        return test_support::confocal_scan(points);
    }();
    renderer::Scene scene = [this] {
        renderer::SceneGeometry geometry;
        geometry.objects.push_back(test_support::parallelogram_object(
            {Vec3(-0.3, -0.2, 0.7), Vec3(0.5, 0.0, 0.15), Vec3(-0.05, 0.45, -0.1), 0.6}));
        geometry.objects.push_back(test_support::parallelogram_object(
            {Vec3(-0.1, -0.1, 0.4), Vec3(0.2, 0.0, 0.02), Vec3(0.02, 0.2, 0.0), 0.3}));
        geometry.objects.push_back(test_support::sphere_object(Vec3(0.2, 0.2, 0.5), 0.1, 3, 0.5));
        return renderer::Scene(std::move(geometry), scan, {});
    }();
    core::TimeAxis axis{0.8, 0.02, 60};
    renderer::ElementSet elements = test_support::single_cut({scene, scan, axis, 0.0}, 0.01);

    std::vector<WallPoint> points(std::size_t begin, std::size_t count) const {
        std::vector<WallPoint> result;
        for (std::size_t i = begin; i < begin + count; ++i) {
            result.push_back({scan.sensing.positions[i] - elements.origin,
                              scan.sensing.normals[i],
                              static_cast<std::uint32_t>(i)});
        }
        return result;
    }
    std::uint32_t any_element(core::Rng& rng) const {
        const auto block =
            static_cast<std::size_t>(rng.uniform() * static_cast<double>(elements.blocks.size()));
        const auto lane = static_cast<std::size_t>(
            rng.uniform() * static_cast<double>(elements.blocks[block].count));
        return static_cast<std::uint32_t>(block * ElementBlock::kSize + lane);
    }
};

TEST(ShadowRayTracer, AnswersAsSingleRays) {
    const HalfHiddenSheet setup;
    core::Rng rng(test_support::seed_of("ShadowRayTracer.single"), 0, 0);
    renderer::ShadowRayTracer tracer(setup.scene, setup.elements);
    std::uint64_t num_rays = 0;
    int num_seen = 0;
    for (const std::size_t count : {std::size_t{1}, std::size_t{7}, WallPointLanes::kSize}) {
        const std::vector<WallPoint> points = setup.points(3, count);
        const WallPointLanes lanes(points);
        tracer.look_from(lanes);
        std::vector<ShadowRays> all(300);
        for (ShadowRays& rays : all) {
            rays.element = setup.any_element(rng);
            rays.points = static_cast<PointMask>(rng.next_bits() & lanes.all());
            if (rng.uniform() < 0.3) rays.points = lanes.all();
            rays.part = static_cast<std::uint8_t>(rng.uniform() * 20.0);
        }
        tracer.trace(all);
        for (const ShadowRays& rays : all) {
            num_rays += static_cast<std::uint64_t>(std::popcount(rays.points));
            EXPECT_EQ(rays.seen & ~rays.points, 0);
            const ElementBlock& block = setup.elements.blocks[rays.element / ElementBlock::kSize];
            const std::size_t i = rays.element % ElementBlock::kSize;
            const Vec3 normal = block.normal[i];
            const renderer::DrawnParts parts = tracer.drawn_parts(rays.element);
            for (std::size_t p = 0; p < count; ++p) {
                if ((rays.points >> p & 1U) == 0) continue;
                const std::uint32_t bit = rays.part < ShadowRays::kFirstFixed
                                              ? parts.bit(p, parts.quarter(p, rays.part))
                                              : rays.part - ShadowRays::kFirstFixed;
                const auto& barycentric = renderer::centers_of_bits()[bit];
                Vec3 end = setup.elements.origin;
                for (std::size_t c = 0; c < 3; ++c) {
                    end += barycentric[c] * block.corners[c][i];
                }
                const Vec3 from = points[p].position + setup.elements.origin;
                end += std::copysign(block.rise_m[i], normal.dot(from - end)) * normal;
                const bool blocked =
                    setup.scene.rays().is_blocked(from, points[p].normal, end, normal);
                EXPECT_EQ((rays.seen >> p & 1U) != 0, !blocked);
                num_seen += !blocked;
            }
        }
    }
    EXPECT_EQ(tracer.cost().num_rays, num_rays);
    EXPECT_GT(num_seen, static_cast<int>(num_rays / 4));
    EXPECT_LT(num_seen, static_cast<int>(num_rays * 3 / 4));
}

// Together with those of another point and of another element: 256 pairs of equal frequency.
TEST(DrawnParts, AreUniformAndIndependent) {
    const HalfHiddenSheet setup;
    renderer::ShadowRayTracer tracer(setup.scene, setup.elements);
    const WallPointLanes lanes(setup.points(0, WallPointLanes::kSize));
    tracer.look_from(lanes);
    std::vector<std::uint32_t> firsts;  // by element and point
    for (std::uint32_t b = 0; b < setup.elements.blocks.size(); ++b) {
        for (std::uint32_t lane = 0; lane < setup.elements.blocks[b].count; ++lane) {
            const auto parts =
                tracer.drawn_parts(b * static_cast<std::uint32_t>(ElementBlock::kSize) + lane);
            for (std::size_t p = 0; p < WallPointLanes::kSize; ++p) {
                std::uint32_t quarters = 0;
                for (std::uint32_t k = 0; k < 4; ++k) {
                    const std::uint32_t quarter = parts.quarter(p, k);
                    EXPECT_EQ(parts.bit(p, quarter) / 4, quarter);
                    quarters |= 1U << quarter;
                }
                EXPECT_EQ(quarters, 0xfU);
                firsts.push_back(parts.bit(p, parts.quarter(p, 0)));
            }
        }
    }
    for (const std::size_t step : {std::size_t{1}, WallPointLanes::kSize}) {
        std::vector<double> observed(256);
        for (std::size_t i = 0; i + step < firsts.size(); ++i) {
            observed[16 * firsts[i] + firsts[i + step]] += 1.0;
        }
        const double total = std::accumulate(observed.begin(), observed.end(), 0.0);
        EXPECT_GT(total, 256.0 * 20.0);
        const std::vector<double> expected(256, total / 256.0);
        EXPECT_GT(test_support::chi_square_p_value(observed, expected), 1e-4) << step;
    }
}

struct LookingTowards {
    std::optional<WallPoint> other_end;
    renderer::ShadowRayPlan plan;
};

class VisibilityTracerTowards : public testing::TestWithParam<LookingTowards> {};

// With the same number of rays, too.
TEST_P(VisibilityTracerTowards, PointsSeeTogetherWhatTheySeeAlone) {
    const HalfHiddenSheet setup;
    renderer::VisibilityTracer tracer(setup.scene, setup.elements);
    renderer::VisibilityRules rules;
    rules.other_end = GetParam().other_end;
    rules.plan = GetParam().plan;
    const std::vector<WallPoint> points = setup.points(5, WallPointLanes::kSize);
    for (std::size_t p = 0; p < points.size(); ++p) {
        // Some gates, some that hold everything.
        const double begin = 1.0 + 0.01 * static_cast<double>(p);
        rules.opl.push_back(p % 3 == 0 ? renderer::LengthBounds{0.0, 9.0}
                                       : renderer::LengthBounds{begin, begin + 0.1});
    }
    std::vector<renderer::VisibleElements> together(points.size());
    tracer.trace(points, rules, together);
    const std::uint64_t num_rays = tracer.cost().num_rays;
    std::size_t num_partial = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
        renderer::VisibilityRules own = rules;
        own.opl = {rules.opl[p]};
        std::vector<renderer::VisibleElements> alone(1);
        tracer.trace({&points[p], 1}, own, alone);
        EXPECT_EQ(alone[0].simd_groups, together[p].simd_groups);
        EXPECT_EQ(alone[0].squared_error, together[p].squared_error);
        for (std::size_t b = 0; b < setup.elements.blocks.size(); ++b) {
            renderer::for_each_simd_group(alone[0].simd_groups[b], [&](std::size_t begin) {
                for (std::size_t i = begin; i < begin + ElementBlock::kSimdWidth; ++i) {
                    const VisibilityMask mask = alone[0].masks[b * ElementBlock::kSize + i];
                    EXPECT_EQ(mask, together[p].masks[b * ElementBlock::kSize + i]);
                    num_partial += mask != 0 && mask != renderer::kAllVisible;
                }
            });
        }
    }
    EXPECT_EQ(tracer.cost().num_rays, 2 * num_rays);
    EXPECT_GT(num_partial, 20U);
}

const WallPoint kFarEnd{Vec3(0.1, 0.0, -0.4), Vec3::UnitZ(), 0};

INSTANTIATE_TEST_SUITE_P(
    Ends,
    VisibilityTracerTowards,
    testing::Values(LookingTowards{std::nullopt, renderer::ShadowRayPlan::WhereNeighboursDisagree},
                    LookingTowards{kFarEnd, renderer::ShadowRayPlan::WhereNeighboursDisagree},
                    LookingTowards{std::nullopt, renderer::ShadowRayPlan::Everywhere},
                    LookingTowards{kFarEnd, renderer::ShadowRayPlan::Everywhere}));

// The ends of a curved wall have no plane in common; one behind which the sheet lies takes nothing
// from another one that sees it.
TEST(ThirdBounceScan, OtherEndsInOtherPlanesTakeNothingAway) {
    const auto histogram = [](const std::vector<Vec3>& sensors) {
        const core::WallScan scan = test_support::exhaustive_scan({Vec3(0.1, 0.0, 0.0)}, sensors);
        renderer::SceneGeometry geometry;
        geometry.objects.push_back(test_support::parallelogram_object(
            {Vec3(-0.2, -0.2, 0.5), Vec3(0.4, 0.0, 0.0), Vec3(0.0, 0.4, 0.05), 0.5}));
        const renderer::Scene scene(std::move(geometry), scan, {});
        const core::TimeAxis axis{0.8, 0.02, 60};
        const renderer::ElementSet elements =
            test_support::single_cut({scene, scan, axis, 0.0}, 0.01);
        renderer::ThirdBounceScan integrator(scene, scan, axis, {.memory_bytes = 1e9});
        core::Transient result(scan.num_pairs(), axis.num_bins);
        integrator.integrate(elements, result);
        const auto values = result.histogram(0);
        return std::vector<double>(values.begin(), values.end());
    };
    const Vec3 near_wall(0.0, 0.0, 0.0);
    const std::vector<double> alone = histogram({near_wall});
    const std::vector<double> beside = histogram({near_wall, Vec3(0.0, 2.0, 3.0)});
    const double sum = std::accumulate(alone.begin(), alone.end(), 0.0);
    EXPECT_GT(sum, 0.0);
    EXPECT_NEAR(std::accumulate(beside.begin(), beside.end(), 0.0), sum, 1e-3 * sum);
}

}  // namespace
