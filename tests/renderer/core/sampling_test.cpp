// SPDX-License-Identifier: MIT
#include "renderer/core/sampling.h"

#include "renderer/core/random.h"
#include "tests/support/inverse_sampling.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <functional>

namespace {

using core::Vec2;
using core::Vec3;

constexpr int kCells = 10;
constexpr int kDraws = 100'000;

// Chi-square of directions over a grid of (z, azimuth); `pdf` integrated by midpoints per cell.
double direction_p_value(const std::function<Vec3(const Vec2&)>& sample,
                         const std::function<double(const Vec3&)>& pdf) {
    std::vector<double> observed(kCells * kCells, 0.0);
    std::vector<double> expected(kCells * kCells, 0.0);
    core::Rng rng(test_support::seed_of("Sampling.directions"), 0, 0);
    for (int i = 0; i < kDraws; ++i) {
        const double u1 = rng.uniform();
        const Vec3 d = sample({u1, rng.uniform()});
        double azimuth = std::atan2(d.y(), d.x()) / (2.0 * core::kPi);
        if (azimuth < 0.0) azimuth += 1.0;
        const int row = std::clamp(static_cast<int>((d.z() + 1.0) / 2.0 * kCells), 0, kCells - 1);
        const int column = std::clamp(static_cast<int>(azimuth * kCells), 0, kCells - 1);
        observed[static_cast<std::size_t>(row * kCells + column)] += 1.0;
    }
    constexpr int kFine = 200;
    for (int row = 0; row < kCells * kFine; ++row) {
        const double z = 2.0 * (row + 0.5) / (kCells * kFine) - 1.0;
        const double radius = std::sqrt(1.0 - z * z);
        for (int column = 0; column < kCells; ++column) {
            const double angle = 2.0 * core::kPi * (column + 0.5) / kCells;
            const Vec3 d(radius * std::cos(angle), radius * std::sin(angle), z);
            expected[static_cast<std::size_t>(row / kFine * kCells + column)] +=
                kDraws * pdf(d) * (2.0 / (kCells * kFine)) * (2.0 * core::kPi / kCells);
        }
    }
    return test_support::chi_square_p_value(observed, expected);
}

TEST(Sampling, CosineHemisphereMatchesItsDensity) {
    EXPECT_GT(direction_p_value(core::sample_cosine_hemisphere, core::pdf_cosine_hemisphere), 1e-4);
}

TEST(Sampling, SphereMatchesItsDensity) {
    EXPECT_GT(
        direction_p_value(core::sample_sphere, [](const Vec3&) { return core::pdf_sphere(); }),
        1e-4);
}

TEST(Sampling, TrianglePointsAreUniformByArea) {
    // Four similar parts of the triangle, cut at the edge midpoints, have equal area.
    std::vector<double> observed(4, 0.0);
    core::Rng rng(test_support::seed_of("Sampling.triangle"), 0, 0);
    for (int i = 0; i < kDraws; ++i) {
        const double u1 = rng.uniform();
        const Vec2 b = core::sample_triangle({u1, rng.uniform()});
        ASSERT_GE(b.minCoeff(), 0.0);
        ASSERT_LE(b.sum(), 1.0);
        const std::size_t part = b.x() > 0.5 ? 0 : b.y() > 0.5 ? 1 : b.sum() < 0.5 ? 2 : 3;
        observed[part] += 1.0;
    }
    EXPECT_GT(test_support::chi_square_p_value(observed, std::vector<double>(4, kDraws / 4.0)),
              1e-4);
}

TEST(Sampling, InversesReturnTheNumbersDrawn) {
    core::Rng rng(test_support::seed_of("Sampling.inverse"), 0, 0);
    for (int i = 0; i < 1000; ++i) {
        const double u1 = rng.uniform();
        const Vec2 u(u1, rng.uniform());
        EXPECT_LT((test_support::invert_triangle(core::sample_triangle(u)) - u).norm(), 1e-12);
        EXPECT_LT((test_support::invert_sphere(core::sample_sphere(u)) - u).norm(), 1e-9);
        EXPECT_LT(
            (test_support::invert_cosine_hemisphere(core::sample_cosine_hemisphere(u)) - u).norm(),
            1e-9);
    }
}

TEST(DiscreteDistribution, PicksInProportionToWeights) {
    const std::vector<double> weights{1.0, 0.0, 3.0, 0.5, 0.0};
    const core::DiscreteDistribution distribution(weights);
    std::vector<double> observed(weights.size(), 0.0);
    std::vector<double> expected;
    core::Rng rng(test_support::seed_of("DiscreteDistribution"), 0, 0);
    for (int i = 0; i < kDraws; ++i) {
        double remapped = 0.0;
        observed[distribution.sample(rng.uniform(), remapped)] += 1.0;
    }
    for (const double weight : weights) expected.push_back(kDraws * weight / 4.5);
    EXPECT_GT(test_support::chi_square_p_value(observed, expected), 1e-4);
    EXPECT_EQ(observed[1], 0.0);
    EXPECT_EQ(observed[4], 0.0);
}

TEST(DiscreteDistribution, InverseAndIntervalsAgreeWithSample) {
    core::Rng rng(test_support::seed_of("DiscreteDistribution.inverse"), 0, 0);
    std::vector<double> weights;
    for (int i = 0; i < 1000; ++i) weights.push_back(rng.uniform());
    const core::DiscreteDistribution distribution(weights);
    for (const std::size_t count : {5000, 300}) {
        std::size_t hint = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const double u = (static_cast<double>(i) + rng.uniform()) / static_cast<double>(count);
            const auto interval = distribution.interval_from(hint, u);
            hint = interval.index;
            EXPECT_LE(interval.begin, u);
            EXPECT_LT(u, interval.end);
            double remapped = 0.0;
            EXPECT_EQ(interval.index, distribution.sample(u, remapped));
            EXPECT_EQ(interval.remap(u), remapped);
            EXPECT_NEAR(interval.begin + remapped * (interval.end - interval.begin), u, 1e-12);
        }
    }
}

}  // namespace
