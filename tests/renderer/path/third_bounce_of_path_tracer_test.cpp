// SPDX-License-Identifier: MIT
// The path tracer's third bounce against closed forms and brute force, in absolute units.
#include "renderer/core/system/parallel.h"
#include "renderer/render.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace {

using core::Vec3;
using test_support::kBlackScreen;
using test_support::kThreeWallPoints;
using test_support::kTiltedPanel;
using test_support::Parallelogram;

renderer::RenderSettings path_settings(const std::string& test, int samples) {
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::Path;
    settings.samples = samples;
    settings.seed = test_support::seed_of(test);
    settings.variance = true;
    return settings;
}

renderer::Scene scene_of(const std::vector<Parallelogram>& shapes,
                         const core::WallScan& scan,
                         double wall_albedo) {
    renderer::SceneGeometry geometry;
    for (const Parallelogram& shape : shapes) {
        geometry.objects.push_back(test_support::parallelogram_object(shape));
    }
    renderer::RelayWall wall;
    wall.albedo = wall_albedo;
    return {std::move(geometry), scan, wall};
}

// Confocal, a plane at depth z parallel to the wall: with r = tau/2 the density in r is
// (rho_w/pi)^2 (rho/pi) (z/r)^4 2 pi r / r^4, so a bin holds (rho_w/pi)^2 rho z^4/3 [r0^-6 -
// r1^-6]. The plane is large enough that all of it within the axis lies inside.
TEST(PathTracer, LargeParallelPlaneMatchesTheClosedForm) {
    constexpr double kDepth = 0.5;
    constexpr double kAlbedo = 0.7;
    constexpr double kWallAlbedo = 0.9;
    const core::WallScan scan = test_support::confocal_scan({Vec3::Zero()});
    const core::TimeAxis axis{0.99, 0.025, 20};
    const renderer::Scene scene = scene_of(
        {{Vec3(-1, -1, kDepth), Vec3(2, 0, 0), Vec3(0, 2, 0), kAlbedo}}, scan, kWallAlbedo);
    const auto result = renderer::render(
        scene, scan, axis, path_settings("LargeParallelPlane", 4'000'000), core::Progress{});

    std::vector<float> expected;
    for (int bin = 0; bin < axis.num_bins; ++bin) {
        const double r0 = std::max(kDepth, axis.bin_begin_m(bin) / 2);
        const double r1 = std::max(kDepth, axis.bin_begin_m(bin + 1) / 2);
        expected.push_back(static_cast<float>(std::pow(kWallAlbedo / core::kPi, 2) * kAlbedo *
                                              std::pow(kDepth, 4) / 3.0 *
                                              (std::pow(r0, -6) - std::pow(r1, -6))));
    }
    const auto measured = result.capture.transient.histogram(0);
    for (std::size_t bin = 0; bin < expected.size(); ++bin) {
        EXPECT_NEAR(measured[bin] / expected[bin], 1.0, 0.01) << "bin " << bin;
    }
    EXPECT_LT(test_support::relative_l2(measured, expected), 0.005);
}

class ThirdBouncePatterns : public testing::TestWithParam<core::ScanPattern> {
 protected:
    core::WallScan scan() const {
        if (GetParam() == core::ScanPattern::Confocal)
            return test_support::confocal_scan(kThreeWallPoints);
        if (GetParam() == core::ScanPattern::Single) {
            return test_support::single_scan(Vec3(0.1, 0.2, 0.0), kThreeWallPoints);
        }
        return test_support::exhaustive_scan({Vec3(0.1, 0.2, 0.0), Vec3(-0.4, -0.4, 0.0)},
                                             kThreeWallPoints);
    }
};

TEST_P(ThirdBouncePatterns, OccludedTiltedRectangleMatchesBruteForce) {
    const core::TimeAxis axis{1.2, 0.02, 40};
    const core::WallScan pairs = scan();
    const auto expected = test_support::third_bounce_by_quadrature(
        kTiltedPanel, kBlackScreen, pairs, axis, 0.8, /*steps=*/1500);
    // The occluder is black: it hides and adds nothing.
    const auto result = renderer::render(scene_of({kTiltedPanel, kBlackScreen}, pairs, 0.8),
                                         pairs,
                                         axis,
                                         path_settings("OccludedTiltedRectangle", 1'000'000),
                                         core::Progress{});
    EXPECT_LT(test_support::relative_l2(result.capture.transient.values(), expected), 0.01);

    // Every bin within its confidence interval, at a family-wise level. The variance comes from
    // some thousand passes, the quadrature's own error is far below it.
    const double level = test_support::sidak_level(1e-3, expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const double sigma = std::sqrt(double{result.capture.variance->values()[i]});
        const double difference =
            double{result.capture.transient.values()[i]} - double{expected[i]};
        const double bias = 2e-4 * double{expected[i]};
        if (sigma == 0.0) {
            EXPECT_LE(std::abs(difference), 1e-3 * double{expected[i]} + 1e-9) << "value " << i;
            continue;
        }
        const double z = std::max(0.0, std::abs(difference) - bias) / sigma;
        EXPECT_GT(test_support::normal_tail(z), level) << "value " << i << " z " << z;
    }
}

TEST_P(ThirdBouncePatterns, SameBitsForAnyNumberOfThreads) {
    const core::TimeAxis axis{1.2, 0.02, 40};
    const core::WallScan pairs = scan();
    const renderer::Scene scene = scene_of({kTiltedPanel, kBlackScreen}, pairs, 0.8);
    renderer::RenderSettings settings = path_settings("SameBits", 300);
    settings.max_bounces = 5;
    std::vector<std::vector<float>> results;
    for (const int threads : {1, 7}) {
        const core::ThreadLimit limit(threads);
        const auto result = renderer::render(scene, pairs, axis, settings, core::Progress{});
        const auto values = result.capture.transient.values();
        results.emplace_back(values.begin(), values.end());
    }
    EXPECT_EQ(results[0], results[1]);
}

INSTANTIATE_TEST_SUITE_P(AllPatterns,
                         ThirdBouncePatterns,
                         testing::Values(core::ScanPattern::Confocal,
                                         core::ScanPattern::Single,
                                         core::ScanPattern::Exhaustive),
                         [](const auto& test) { return std::string(core::enum_name(test.param)); });

// Of eight passes. Who listens slowly is asked after each; the others after rounds of several.
TEST(PathTracer, InterruptedRenderKeepsWholePasses) {
    const core::WallScan scan = test_support::confocal_scan(kThreeWallPoints);
    const renderer::Scene scene = scene_of({kTiltedPanel}, scan, 1.0);
    const core::TimeAxis axis{1.2, 0.02, 40};
    const renderer::RenderSettings settings = path_settings("Interrupted", 800);
    core::Progress progress;
    progress.report = [](double, const std::string&) {
        std::this_thread::sleep_for(std::chrono::milliseconds(110));
    };
    int asked = 0;
    const auto whole_slowly = renderer::render(scene, scan, axis, settings, progress);
    progress.stop_requested = [&] { return ++asked == 3; };
    const auto interrupted = renderer::render(scene, scan, axis, settings, progress);
    EXPECT_TRUE(interrupted.interrupted);
    EXPECT_EQ(interrupted.samples_per_pair, 300U);
    double sum = 0.0;
    for (const float value : interrupted.capture.transient.values()) sum += double{value};
    EXPECT_GT(sum, 0.0);

    const auto whole = renderer::render(scene, scan, axis, settings, {});
    EXPECT_FALSE(whole.interrupted);
    EXPECT_EQ(whole.samples_per_pair, 800U);
    EXPECT_TRUE(std::ranges::equal(whole.capture.transient.values(),
                                   whole_slowly.capture.transient.values()));
}

TEST(PathTracer, GateWeightsPathsByLength) {
    const core::WallScan scan = test_support::confocal_scan({Vec3::Zero()});
    // A tiny patch: one path length, 1.0 m.
    const renderer::Scene scene =
        scene_of({{Vec3(-1e-4, -1e-4, 0.5), Vec3(2e-4, 0, 0), Vec3(0, 2e-4, 0)}}, scan, 1.0);
    const double expected = std::pow(core::kPi, -3) * 4e-8 / std::pow(0.5, 4);
    for (const auto& [gate, weight] :
         {std::pair{renderer::GateShape::Box, 1.0},
          std::pair{renderer::GateShape::Tent, 0.75},
          std::pair{renderer::GateShape::Gaussian, std::exp(-1.0 / 32)}}) {
        renderer::RenderSettings settings = path_settings("GateWeights", 1000);
        settings.gate = gate;
        // Centre at 1.005 m, width 0.02 m: a quarter of the width off.
        const auto result =
            renderer::render(scene, scan, core::TimeAxis{0.995, 0.02, 1}, settings, {});
        EXPECT_NEAR(result.capture.transient.values()[0] / (expected * weight), 1.0, 1e-3);
    }
}

TEST(PathTracer, RetroreflectorReturnsTheSpotOfConfocalPairsOnly) {
    constexpr double kSpot = 2e-4;
    for (const bool confocal : {true, false}) {
        const core::WallScan scan =
            confocal ? test_support::confocal_scan({Vec3::Zero()})
                     : test_support::single_scan(Vec3(0.2, 0, 0), {Vec3::Zero()});
        renderer::SceneGeometry geometry;
        geometry.objects.push_back(test_support::parallelogram_object(
            {Vec3(-1e-4, -1e-4, 0.5), Vec3(2e-4, 0, 0), Vec3(0, 2e-4, 0), 0.9}));
        geometry.objects.back().material.model = renderer::model_of({.retroreflective = true});
        const renderer::Scene scene(std::move(geometry), scan, renderer::RelayWall{});
        renderer::RenderSettings settings = path_settings("Retro", 1000);
        settings.laser_spot_m2 = kSpot;
        const auto result =
            renderer::render(scene, scan, core::TimeAxis{0.9, 0.2, 1}, settings, {});
        const double expected = std::pow(core::kPi, -2) * 0.9 / kSpot * 4e-8 / 0.25;
        EXPECT_NEAR(
            result.capture.transient.values()[0], confocal ? expected : 0.0, 1e-3 * expected);
    }
}

}  // namespace
