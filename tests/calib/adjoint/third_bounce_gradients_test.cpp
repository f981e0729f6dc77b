// SPDX-License-Identifier: MIT
// Gradients of third bounces against differences, and against finer ones.
#include "calib/third_bounce_vjp.h"
#include "tests/support/gradient_case.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using calib::MeshGradients;
using core::Vec3;
using test_support::GradientCase;
using test_support::OccludedMesh;
using test_support::random_point;

// Rounding adds 1e-7 to differences over this step, and it is too short for the polygons that the
// kernel sees to change their number more than now and then; over 1e-5 they do, and every time the
// histograms jump by part of their error.
constexpr double kStep_m = 1e-7;
constexpr double kTolerance = 1e-4;
constexpr std::uint64_t kNumCases = 20;

// A vertex of each object, see random_occluded_mesh().
constexpr std::array<std::size_t, 5> kVertices{4, 7, 10, 14, 20};

TEST(ThirdBounceGradients, GradientsByVerticesMatchDifferences) {
    std::size_t num_seen = 0;
    for (std::uint64_t number = 0; number < kNumCases; ++number) {
        const GradientCase example(number);
        const MeshGradients gradients = example.gradients();
        for (const std::size_t v : kVertices) {
            Vec3 differences;
            for (Eigen::Index a = 0; a < 3; ++a) {
                std::vector<Vec3> motion(gradients.vertices.size(), Vec3::Zero());
                motion[v][a] = 1.0;
                differences[a] = example.difference(motion, kStep_m);
            }
            const Vec3& gradient = gradients.vertices[v];
            num_seen += gradient.norm() > 0.0;
            for (Eigen::Index a = 0; a < 3; ++a) {
                EXPECT_NEAR(gradient[a], differences[a], kTolerance * gradient.norm())
                    << "case " << number << ", vertex " << v << ", coordinate " << a;
            }
        }
    }
    // Some stand in the shade of others, where nothing depends on them.
    EXPECT_GE(num_seen, 90U);
}

TEST(ThirdBounceGradients, GradientsOfAFacetThroughTheWallMatchDifferences) {
    GradientCase example(1);
    example.shapes = {};
    example.shapes.add(
        {Vec3(0.4, -0.4, -0.31), Vec3(0.45, 0.4, -0.13), Vec3(0.5, 0.1, 0.62)}, {{0, 1, 2}}, 0.8);
    const MeshGradients gradients = example.gradients();
    for (std::size_t v = 0; v < 3; ++v) {
        for (Eigen::Index a = 0; a < 3; ++a) {
            std::vector<Vec3> motion(3, Vec3::Zero());
            motion[v][a] = 1.0;
            EXPECT_NEAR(example.difference(motion, kStep_m),
                        gradients.vertices[v][a],
                        kTolerance * gradients.vertices[v].norm())
                << "vertex " << v << ", coordinate " << a;
        }
    }
}

TEST(ThirdBounceGradients, DirectionalDerivativesMatchDifferences) {
    for (std::uint64_t number = 0; number < kNumCases; ++number) {
        const GradientCase example(number);
        const MeshGradients gradients = example.gradients();
        core::Rng rng(test_support::seed_of("directions"), number, 0);
        for (int direction = 0; direction < 3; ++direction) {
            double expected = 0.0;
            double squared = 0.0;
            std::vector<Vec3> motion;
            for (const Vec3& gradient : gradients.vertices) {
                motion.push_back(random_point(rng));
                expected += gradient.dot(motion.back());
                squared += gradient.squaredNorm();
            }
            EXPECT_NEAR(example.difference(motion, kStep_m),
                        expected,
                        kTolerance * std::max(std::abs(expected), 0.1 * std::sqrt(squared)))
                << "case " << number << ", direction " << direction;
        }
    }
}

TEST(ThirdBounceGradients, GradientsByAlbedoMatchDifferences) {
    for (std::uint64_t number = 0; number < 4; ++number) {
        const GradientCase example(number);
        const MeshGradients gradients = example.gradients();
        const double value = example.value(example.shapes);
        for (std::size_t facet = 0; facet < gradients.albedo.size(); ++facet) {
            OccludedMesh brighter = example.shapes;
            brighter.albedo[facet] += 0.1;  // histograms are linear in it
            EXPECT_NEAR((example.value(brighter) - value) / 0.1,
                        gradients.albedo[facet],
                        1e-12 + 1e-9 * std::abs(gradients.albedo[facet]))
                << "case " << number << ", facet " << facet;
        }
    }
}

double relative_difference(const MeshGradients& a, const MeshGradients& b) {
    double difference = 0.0;
    double size = 0.0;
    for (std::size_t v = 0; v < b.vertices.size(); ++v) {
        difference += (a.vertices[v] - b.vertices[v]).squaredNorm();
        size += b.vertices[v].squaredNorm();
    }
    return std::sqrt(difference / size);
}

// Gradients are those of histograms with the tolerance's error, not of exact ones. Facets that the
// shortest paths meet in their inside are worst: what they send back begins with a step.
TEST(ThirdBounceGradients, GradientsConvergeWithTheTolerance) {
    constexpr int kCases = 8;
    constexpr std::array<double, 3> kTolerances{0.02, 0.005, 0.00125};
    std::array<double, 3> light_errors{};
    std::array<double, 3> errors{};
    for (std::uint64_t number = 0; number < kCases; ++number) {
        GradientCase example(number);
        // What pulls at a fit: the difference from where everything is a little elsewhere.
        OccludedMesh moved = example.shapes;
        core::Rng rng(test_support::seed_of("moved"), number, 0);
        for (Vec3& vertex : moved.mesh.vertices) vertex += 0.02 * random_point(rng);
        const auto here = example.vjp(example.shapes).histograms();
        const auto there = example.vjp(moved).histograms();
        for (std::size_t i = 0; i < here.size(); ++i) example.weights[i] = here[i] - there[i];
        example.settings.tolerance = 1e-4;
        const auto best_light = example.vjp(example.shapes).histograms();
        const MeshGradients best = example.gradients();
        for (std::size_t i = 0; i < kTolerances.size(); ++i) {
            example.settings.tolerance = kTolerances[i];
            const auto light = example.vjp(example.shapes).histograms();
            light_errors[i] +=
                test_support::relative_l2(std::span<const double>(light), best_light) / kCases;
            errors[i] += relative_difference(example.gradients(), best) / kCases;
        }
    }
    EXPECT_LT(light_errors[0], 0.015);
    EXPECT_LT(light_errors[1], 0.003);
    EXPECT_LT(light_errors[2], 0.0006);
    EXPECT_LT(errors[0], 0.15);
    EXPECT_LT(errors[1], 0.05);
    EXPECT_LT(errors[2], 0.02);
}

}  // namespace
