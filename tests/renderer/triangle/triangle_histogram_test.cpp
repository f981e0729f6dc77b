// SPDX-License-Identifier: MIT
// The closed-form kernel against sampling, exact arcs and the laws it must obey.
#include "renderer/triangle/triangle_histogram.h"

#include "renderer/core/random.h"
#include "renderer/core/sampling.h"
#include "tests/support/exact_arcs.h"
#include "tests/support/single_triangle.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

namespace {

using core::TimeAxis;
using core::Vec3;
using renderer::TriangleKnots;
using test_support::relative_l2;
using Corners = std::array<Vec3, 3>;

std::vector<double> histogram_of(const TriangleKnots& knots, double area, const TimeAxis& axis) {
    std::vector<double> histogram(static_cast<std::size_t>(axis.num_bins));
    test_support::add_triangle(knots, area, axis, histogram);
    return histogram;
}

TriangleKnots random_knots(core::Rng& rng) {
    TriangleKnots knots;
    for (double& opl : knots.opl_m) opl = 1.0 + 0.1 * rng.uniform();
    for (double& weight : knots.weight) weight = rng.uniform();
    return knots;
}

// Confocal weight of section 1 of the forward model, without albedo and constants.
double confocal_weight(const Vec3& offset, const Vec3& wall_normal, const Vec3& normal) {
    const double front = std::max(0.0, wall_normal.dot(offset));
    const double facing = normal.dot(offset);
    return front * front * facing * facing / std::pow(offset.squaredNorm(), 4);
}

TriangleKnots confocal_knots(const Corners& corners, const Vec3& wall_normal, const Vec3& normal) {
    TriangleKnots at_corners;
    TriangleKnots at_midpoints;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 middle = 0.5 * (corners[i] + corners[(i + 1) % 3]);
        at_corners.opl_m[i] = 2.0 * corners[i].norm();
        at_corners.weight[i] = confocal_weight(corners[i], wall_normal, normal);
        at_midpoints.opl_m[i] = 2.0 * middle.norm();
        at_midpoints.weight[i] = confocal_weight(middle, wall_normal, normal);
    }
    return renderer::match_midpoints(at_corners, at_midpoints);
}

// Cuts the triangle into steps^2 congruent ones and adds each. The wall point is the origin.
std::vector<double> parts_of(const Corners& corners,
                             const Vec3& wall_normal,
                             const TimeAxis& axis,
                             int steps) {
    const Vec3 e1 = (corners[1] - corners[0]) / steps;
    const Vec3 e2 = (corners[2] - corners[0]) / steps;
    const Vec3 area_vector = 0.5 * e1.cross(e2);
    const Vec3 normal = area_vector.normalized();
    std::vector<double> histogram(static_cast<std::size_t>(axis.num_bins));
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; i + j < steps; ++j) {
            const Vec3 p = corners[0] + i * e1 + j * e2;
            const Corners lower{p, p + e1, p + e2};
            test_support::add_triangle(
                confocal_knots(lower, wall_normal, normal), area_vector.norm(), axis, histogram);
            if (i + j + 1 == steps) continue;
            const Corners upper{p + e1, p + e1 + e2, p + e2};
            test_support::add_triangle(
                confocal_knots(upper, wall_normal, normal), area_vector.norm(), axis, histogram);
        }
    }
    return histogram;
}

TEST(TriangleHistogram, MatchesMidpointSamplingOfTheLinearTriangle) {
    core::Rng rng(test_support::seed_of("MatchesMidpointSampling"), 0, 0);
    const TimeAxis axis{0.99, 0.007, 20};
    for (int trial = 0; trial < 20; ++trial) {
        const TriangleKnots knots = random_knots(rng);
        std::vector<double> expected(20);
        constexpr int kSteps = 700;
        for (int i = 0; i < kSteps; ++i) {
            for (int j = 0; j < kSteps; ++j) {
                const core::Vec2 b =
                    core::sample_triangle({(i + 0.5) / kSteps, (j + 0.5) / kSteps});
                const double b0 = 1.0 - b.x() - b.y();
                const double opl =
                    b0 * knots.opl_m[0] + b.x() * knots.opl_m[1] + b.y() * knots.opl_m[2];
                const double weight =
                    b0 * knots.weight[0] + b.x() * knots.weight[1] + b.y() * knots.weight[2];
                expected[static_cast<std::size_t>(axis.bin_of(opl).value())] +=
                    3.0 * weight / (kSteps * kSteps);
            }
        }
        EXPECT_LT(relative_l2(histogram_of(knots, 3.0, axis), expected), 2e-3) << trial;
    }
}

TEST(TriangleHistogram, BinsAreDifferencesOfTheCumulative) {
    core::Rng rng(test_support::seed_of("BinsAreDifferences"), 0, 0);
    const TimeAxis axis{0.98, 0.011, 14};
    for (int trial = 0; trial < 100; ++trial) {
        const TriangleKnots knots = random_knots(rng);
        const auto histogram = histogram_of(knots, 2.0, axis);
        for (int bin = 0; bin < axis.num_bins; ++bin) {
            const double expected =
                2.0 * (renderer::triangle_cumulative(knots, axis.bin_begin_m(bin + 1)) -
                       renderer::triangle_cumulative(knots, axis.bin_begin_m(bin)));
            EXPECT_NEAR(histogram[static_cast<std::size_t>(bin)], expected, 1e-12);
        }
    }
}

// Triangles of all spans, some on no bin, some partly outside; the lanes after them hold others.
TEST(TriangleHistogram, LanesAddWhatEachTriangleAloneDoes) {
    core::Rng rng(test_support::seed_of("LanesAddWhatEachDoes"), 0, 0);
    const TimeAxis axis{1.02, 0.007, 9};
    for (std::size_t count = 1; count <= renderer::TriangleLanes::kSize; ++count) {
        renderer::TriangleLanes lanes;
        std::vector<double> expected(9);
        for (std::size_t i = 0; i < renderer::TriangleLanes::kSize; ++i) {
            TriangleKnots knots = random_knots(rng);
            const double spread = i % 3 == 0 ? 0.0 : rng.uniform();
            for (double& opl : knots.opl_m) opl = knots.opl_m[2] + spread * (opl - knots.opl_m[2]);
            if (i % 7 == 3) knots.weight = {0.0, 0.0, 0.0};
            for (std::size_t j = 0; j < 3; ++j) {
                lanes.opl_m[j][i] = knots.opl_m[j];
                lanes.bend_m[j][i] = 0.0;
                lanes.weight[j][i] = knots.weight[j];
            }
            lanes.area_m2[i] = rng.uniform();
            if (i < count) test_support::add_triangle(knots, lanes.area_m2[i], axis, expected);
        }
        std::vector<double> histogram(9);
        renderer::add_triangles(lanes, count, axis, histogram);
        for (std::size_t bin = 0; bin < 9; ++bin) {
            EXPECT_NEAR(histogram[bin], expected[bin], 1e-13) << count;
        }
    }
}

TEST(TriangleHistogram, UnusedLanesMayHoldAnything) {
    renderer::TriangleLanes lanes;
    for (auto* values : {&lanes.opl_m, &lanes.bend_m, &lanes.weight}) {
        for (auto& of_corner : *values) of_corner.fill(std::numeric_limits<double>::quiet_NaN());
    }
    lanes.area_m2.fill(std::numeric_limits<double>::quiet_NaN());
    lanes.area_m2[0] = 2.0;
    for (std::size_t j = 0; j < 3; ++j) {
        lanes.opl_m[j][0] = 1.0 + 0.01 * static_cast<double>(j);
        lanes.bend_m[j][0] = 0.0;
        lanes.weight[j][0] = 0.5;
    }
    std::vector<double> histogram(8);
    renderer::add_triangles(lanes, 1, {0.99, 0.005, 8}, histogram);
    EXPECT_NEAR(std::accumulate(histogram.begin(), histogram.end(), 0.0), 1.0, 1e-14);
}

TEST(TriangleHistogram, EnergyDoesNotDependOnTheAxis) {
    core::Rng rng(test_support::seed_of("EnergyDoesNotDependOnTheAxis"), 0, 0);
    for (int trial = 0; trial < 200; ++trial) {
        const TriangleKnots knots = random_knots(rng);
        const double expected = (knots.weight[0] + knots.weight[1] + knots.weight[2]) / 3.0;
        const double width = std::exp(-9.0 * rng.uniform());
        const TimeAxis axis{0.9 - width * rng.uniform(), width, static_cast<int>(0.4 / width) + 3};
        EXPECT_NEAR(test_support::sum_of(histogram_of(knots, 1.0, axis)) / expected, 1.0, 1e-12)
            << trial;
    }
}

TEST(TriangleHistogram, PartOutsideTheAxisIsLeftOut) {
    const TriangleKnots knots{{1.0, 1.02, 1.05}, {1.0, 2.0, 0.5}};
    const TimeAxis whole{0.995, 0.005, 12};
    const auto all = histogram_of(knots, 1.0, whole);
    for (int first = 0; first < whole.num_bins; ++first) {
        for (int count = 1; first + count <= whole.num_bins; ++count) {
            const auto part =
                histogram_of(knots, 1.0, {whole.bin_begin_m(first), whole.bin_width_m, count});
            for (int bin = 0; bin < count; ++bin) {
                EXPECT_NEAR(part[static_cast<std::size_t>(bin)],
                            all[static_cast<std::size_t>(first + bin)],
                            1e-12);
            }
        }
    }
}

TEST(TriangleHistogram, DegenerateTrianglesKeepTheirEnergy) {
    const TimeAxis axis{0.9, 0.01, 30};
    for (const std::array<double, 3>& opl : {std::array{1.0, 1.0, 1.0},
                                             std::array{1.0, 1.0, 1.1},
                                             std::array{1.1, 1.0, 1.1},
                                             std::array{1.0, 1.0 + 1e-16, 1.0 + 1e-12},
                                             std::array{1.05, 1.0 - 1e-13, 1.0 + 1e-13}}) {
        const auto histogram = histogram_of({opl, {1.0, 2.0, 3.0}}, 1.0, axis);
        EXPECT_NEAR(test_support::sum_of(histogram), 2.0, 1e-12);
        for (const double value : histogram) EXPECT_GE(value, -1e-15);
    }
}

TEST(TriangleHistogram, MatchedKnotsHaveTheMidpointsMean) {
    const TriangleKnots corners{{1.0, 1.1, 1.3}, {0.0, 0.01, 1.0}};
    const TriangleKnots midpoints{{1.04, 1.19, 1.14}, {0.001, 0.3, 0.2}};
    const TriangleKnots knots = renderer::match_midpoints(corners, midpoints);
    EXPECT_NEAR(test_support::sum_of({knots.opl_m.begin(), knots.opl_m.end()}), 3.37, 1e-14);
    EXPECT_NEAR(test_support::sum_of({knots.weight.begin(), knots.weight.end()}), 0.501, 1e-14);
    for (const double weight : knots.weight) EXPECT_GE(weight, 0.0);
}

// A triangle as in the design's accuracy table: 0.4 m, tilted, 0.7-0.85 m away.
const Corners kTriangle{Vec3(-0.2, -0.15, 0.7), Vec3(0.2, -0.1, 0.78), Vec3(-0.05, 0.22, 0.85)};

// Mean confocal weight at the centroids of steps^2 congruent triangles.
double centroid_rule(const Corners& corners, const Vec3& normal, int steps) {
    const Vec3 e1 = (corners[1] - corners[0]) / steps;
    const Vec3 e2 = (corners[2] - corners[0]) / steps;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; i + j < steps; ++j) {
            const Vec3 p = corners[0] + i * e1 + j * e2;
            sum += confocal_weight(p + (e1 + e2) / 3.0, Vec3::UnitZ(), normal);
            if (i + j + 1 == steps) continue;
            sum += confocal_weight(p + 2.0 * (e1 + e2) / 3.0, Vec3::UnitZ(), normal);
        }
    }
    return sum / (steps * steps);
}

TEST(ExactArcs, MatchesQuadrature) {
    // The foot of the wall point inside the triangle, on its edge's line, and outside.
    const Corners facing{Vec3(-0.2, -0.2, 0.5), Vec3(0.3, -0.1, 0.5), Vec3(0.0, 0.3, 0.5)};
    const Corners beside{Vec3(0.2, -0.1, 0.4), Vec3(0.6, 0.0, 0.7), Vec3(0.3, 0.4, 0.5)};
    for (const Corners& corners : {kTriangle, facing, beside}) {
        const Vec3 area_vector = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        const Vec3 normal = area_vector.normalized();
        // Richardson's extrapolation of centroid rules.
        const double coarse = centroid_rule(corners, normal, 200);
        const double fine = centroid_rule(corners, normal, 400);
        const double expected = area_vector.norm() * (4.0 * fine - coarse) / 3.0;
        const auto arcs =
            test_support::confocal_arcs(corners, Vec3::Zero(), Vec3::UnitZ(), {0.5, 0.02, 100});
        EXPECT_NEAR(test_support::sum_of(arcs) / expected, 1.0, 1e-9);
    }
}

TEST(ExactArcs, MatchTheKernelOfManyPieces) {
    const TimeAxis axis{1.2, 0.0096, 80};
    const auto arcs = test_support::confocal_arcs(kTriangle, Vec3::Zero(), Vec3::UnitZ(), axis);
    EXPECT_LT(relative_l2(parts_of(kTriangle, Vec3::UnitZ(), axis, 256), arcs), 1e-5);
}

// Relative error 0.1 kappa, kappa = h^2/(8 r w_r), w_r half a bin in range.
TEST(TriangleHistogram, ErrorFollowsTheSizeRule) {
    const TimeAxis axis{1.2, 0.0096, 80};
    const auto arcs = test_support::confocal_arcs(kTriangle, Vec3::Zero(), Vec3::UnitZ(), axis);
    for (const int steps : {4, 8, 16, 32}) {
        const double edge = (kTriangle[1] - kTriangle[0]).norm() / steps;
        const double kappa = edge * edge / (8.0 * 0.75 * axis.bin_width_m / 2.0);
        EXPECT_LT(relative_l2(parts_of(kTriangle, Vec3::UnitZ(), axis, steps), arcs), 0.1 * kappa)
            << steps;
    }
}

std::vector<double> blurred(const std::vector<double>& histogram, double sigma_bins) {
    std::vector<double> result(histogram.size());
    for (std::size_t i = 0; i < histogram.size(); ++i) {
        for (std::size_t j = 0; j < histogram.size(); ++j) {
            const double offset = (static_cast<double>(i) - static_cast<double>(j)) / sigma_bins;
            result[i] += histogram[j] * std::exp(-0.5 * offset * offset);
        }
    }
    return result;
}

TEST(TriangleHistogram, BehindADetectorOf94PicosecondsTheErrorIsThatOfTheDesign) {
    const TimeAxis axis{1.2, 0.0096, 80};
    const double sigma_bins = core::opl_from_seconds(94e-12) / 2.3548 / axis.bin_width_m;
    const auto arcs = blurred(
        test_support::confocal_arcs(kTriangle, Vec3::Zero(), Vec3::UnitZ(), axis), sigma_bins);
    const auto error = [&](int steps) {
        return relative_l2(blurred(parts_of(kTriangle, Vec3::UnitZ(), axis, steps), sigma_bins),
                           arcs);
    };
    EXPECT_LT(error(4), 1.5e-2);  // pieces of 10 cm
    EXPECT_LT(error(8), 1.5e-3);  // and of 5 cm
}

TEST(TriangleHistogram, SubBinShiftsChangeTheEnergyByLessThanOneIn1e5) {
    for (const double shift : {0.0, 0.1, 0.37, 0.5, 0.93}) {
        const TimeAxis axis{1.2 - 0.0096 * shift, 0.0096, 82};
        const auto arcs = test_support::confocal_arcs(kTriangle, Vec3::Zero(), Vec3::UnitZ(), axis);
        const double energy = test_support::sum_of(parts_of(kTriangle, Vec3::UnitZ(), axis, 8));
        EXPECT_NEAR(energy / test_support::sum_of(arcs), 1.0, 1e-5) << shift;
    }
}

// Each hard case with pieces small enough; errors are relative L2 against the arcs.
struct HardCase {
    const char* name;
    Corners corners;
    TimeAxis axis;
    int steps;
    double allowed;
};

class HardFacets : public testing::TestWithParam<HardCase> {};

TEST_P(HardFacets, MatchTheExactArcs) {
    const auto& [name, corners, axis, steps, allowed] = GetParam();
    const auto arcs = test_support::confocal_arcs(corners, Vec3::Zero(), Vec3::UnitZ(), axis);
    const auto parts = parts_of(corners, Vec3::UnitZ(), axis, steps);
    EXPECT_LT(relative_l2(parts, arcs), allowed);
    EXPECT_GT(test_support::sum_of(arcs), 0.0);
}

Corners grazing() {
    // The plane passes the wall point at 0.1 degrees from the direction to the triangle's middle.
    const Vec3 middle(0.1, 0.0, 0.6);
    const Vec3 along = middle.normalized();
    const Vec3 across = Vec3::UnitY();
    const double angle = 0.1 * core::kPi / 180.0;
    const Vec3 in_plane = std::cos(angle) * along + std::sin(angle) * along.cross(across);
    return {
        middle - 0.1 * in_plane, middle + 0.1 * in_plane + 0.05 * across, middle + 0.15 * across};
}

INSTANTIATE_TEST_SUITE_P(
    Cases,
    HardFacets,
    testing::Values(
        HardCase{"GrazingBy0Point1Degrees", grazing(), {0.9, 0.008, 80}, 32, 2e-3},
        HardCase{"TangentPointInside",
                 {Vec3(-0.2, -0.2, 0.5), Vec3(0.3, -0.1, 0.5), Vec3(0.0, 0.3, 0.5)},
                 {0.99, 0.008, 60},
                 64,
                 2e-3},
        HardCase{"SliverOfAspect1e6",
                 {Vec3(-0.2, 0.1, 0.5), Vec3(0.3, 0.1, 0.6), Vec3(0.0, 0.1 + 5e-7, 0.54)},
                 {0.99, 0.008, 60},
                 64,
                 2e-3},
        HardCase{"BinsOf0Point1Millimetre",
                 {Vec3(-0.02, -0.02, 0.5), Vec3(0.03, -0.01, 0.52), Vec3(0.0, 0.03, 0.51)},
                 {0.995, 0.0001, 800},
                 128,
                 2e-3},
        HardCase{"BinsOfOneMetre", kTriangle, {0.0, 1.0, 4}, 16, 1e-5},
        HardCase{"OneMillimetreFromTheWall",
                 {Vec3(0.002, 0.0, 0.001), Vec3(0.006, 0.001, 0.001), Vec3(0.003, 0.004, 0.0015)},
                 {0.0, 0.0005, 40},
                 64,
                 2e-3}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
