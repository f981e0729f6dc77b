// SPDX-License-Identifier: MIT
// The third bounce by batches of elements, and interrupted between them or before.
#include "renderer/third_bounce/third_bounce.h"
#include "tests/renderer/third_bounce/third_bounce_fixture.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <functional>

namespace {

using core::Vec3;
using test_support::kBlackScreen;
using test_support::kThreeWallPoints;
using test_support::kTiltedPanel;
using test_support::Parallelogram;
using third_bounce_test::geometry_of;
using third_bounce_test::kAxis;
using third_bounce_test::kWallAlbedo;
using third_bounce_test::scene_of;
using third_bounce_test::settings_for;
using third_bounce_test::ThirdBounce;

TEST(ThirdBounceScenes, InterruptedRenderIsCompleteButCoarser) {
    const auto grid = [](int width, int height) {
        std::vector<Vec3> points;
        for (int i = 0; i < width * height; ++i) {
            points.emplace_back(
                -0.4 + 0.8 / width * (i % width), -0.4 + 0.8 / height * (i / width), 0.0);
        }
        return points;
    };
    for (const core::WallScan& scan : {test_support::confocal_scan(grid(20, 20)),
                                       test_support::exhaustive_scan(grid(8, 4), grid(8, 8))}) {
        const renderer::Scene scene = scene_of(geometry_of({kTiltedPanel, kBlackScreen}), scan);
        const auto whole = renderer::render(scene, scan, kAxis, settings_for(1e-3), {});
        for (const int patience : {1, 4}) {
            core::Progress progress;
            int asked = 0;
            progress.stop_requested = [&] { return ++asked > patience; };
            const auto early = renderer::render(scene, scan, kAxis, settings_for(1e-3), progress);
            EXPECT_TRUE(early.interrupted);
            EXPECT_GT(*early.estimated_error, *whole.estimated_error);
            const double error = test_support::relative_l2(early.capture.transient.values(),
                                                           whole.capture.transient.values());
            EXPECT_GT(error, 0.0);
            EXPECT_LT(error, *early.estimated_error + *whole.estimated_error);
        }
    }
}

// Where so few points are left that they are integrated at once, too.
TEST(ThirdBounceScenes, RenderInterruptedBeforeItBeginsSaysSo) {
    const core::WallScan scan = test_support::confocal_scan(kThreeWallPoints);
    const renderer::Scene scene = scene_of(geometry_of({kTiltedPanel, kBlackScreen}), scan);
    core::Progress progress;
    progress.stop_requested = [] { return true; };
    const auto early = renderer::render(scene, scan, kAxis, settings_for(1e-4), progress);
    EXPECT_TRUE(early.interrupted);
    EXPECT_GT(test_support::sum_of({early.capture.transient.values().begin(),
                                    early.capture.transient.values().end()}),
              0.0);
}

// The third bounce with at most so many elements in a batch.
renderer::ThirdBounce integrate_by_batches(const std::vector<Parallelogram>& shapes,
                                           const core::WallScan& scan,
                                           const renderer::RenderSettings& settings,
                                           std::size_t in_a_batch) {
    return integrate_third_bounce(scene_of(geometry_of(shapes), scan),
                                  scan,
                                  kAxis,
                                  settings,
                                  {},
                                  {.in_all = 1'000'000, .in_a_batch = in_a_batch});
}

// Where nothing hides anything, only sums are rounded otherwise.
TEST_P(ThirdBounce, BatchesOfElementsAddUp) {
    renderer::RenderSettings settings = settings_for(0.01);
    settings.target_error.reset();
    settings.element_tolerance = 1e-3;
    const auto whole = integrate_by_batches({kTiltedPanel}, scan(), settings, 1'000'000);
    const auto parts = integrate_by_batches({kTiltedPanel}, scan(), settings, 150);
    EXPECT_GT(whole.num_elements, 600U);
    EXPECT_EQ(parts.num_elements, whole.num_elements);
    EXPECT_LT(test_support::relative_l2(parts.transient.values(), whole.transient.values()), 1e-6);
}

// Shadow edges at the borders of batches are found from fewer neighbours.
TEST_P(ThirdBounce, BatchesOfElementsKeepTheTarget) {
    constexpr double kTarget = 0.004;
    const auto expected = test_support::third_bounce_by_quadrature(
        kTiltedPanel, kBlackScreen, scan(), kAxis, kWallAlbedo, /*steps=*/2000);
    const auto parts =
        integrate_by_batches({kTiltedPanel, kBlackScreen}, scan(), settings_for(kTarget), 300);
    EXPECT_GT(parts.num_elements, 600U);
    EXPECT_LE(*parts.estimated_error, kTarget);
    EXPECT_LT(test_support::relative_l2(parts.transient.values(), expected), kTarget + 5e-4);
}

// No pair is complete before the last batch.
TEST(ThirdBounceScenes, InterruptedBetweenBatchesItIsCompleteButCoarser) {
    const core::WallScan scan = test_support::confocal_scan(kThreeWallPoints);
    const renderer::Scene scene = scene_of(geometry_of({kTiltedPanel, kBlackScreen}), scan);
    const auto integrate = [&](const core::Progress& progress) {
        return integrate_third_bounce(scene,
                                      scan,
                                      kAxis,
                                      settings_for(4e-3),
                                      progress,
                                      {.in_all = 1'000'000, .in_a_batch = 300});
    };
    const renderer::ThirdBounce whole = integrate({});
    bool integrates = false;
    int times_asked = 0;
    const auto while_integrating = [&] { return integrates; };
    const auto in_the_first_trial = [&] { return ++times_asked > 0; };
    for (const std::function<bool()>& stop :
         std::vector<std::function<bool()>>{while_integrating, in_the_first_trial}) {
        core::Progress progress;
        progress.report = [&](double fraction, const std::string&) {
            integrates = integrates || fraction > 0.0;
        };
        progress.stop_requested = stop;
        const renderer::ThirdBounce early = integrate(progress);
        EXPECT_TRUE(early.interrupted);
        EXPECT_GT(*early.estimated_error, *whole.estimated_error);
        const double error =
            test_support::relative_l2(early.transient.values(), whole.transient.values());
        EXPECT_GT(error, 0.0);
        EXPECT_LT(error, *early.estimated_error + *whole.estimated_error);
    }
    EXPECT_LT(times_asked, 10) << "it goes on with trial runs";
}

}  // namespace
