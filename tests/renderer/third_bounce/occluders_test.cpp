// SPDX-License-Identifier: MIT
// What third bounces promise of their error, behind occluders of 1 mm to 1 m. The benchmark
// occluder_stress does the same with more scenes and targets.
#include "renderer/render.h"
#include "renderer/third_bounce/pilot_runs.h"
#include "renderer/third_bounce/third_bounce.h"
#include "tests/support/occluder_scenes.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

using core::Vec3;
using test_support::OccluderScene;

struct Promise {
    double target = 0.0;
    double reported = 0.0;
    double error = 0.0;
};

/// What is promised and kept at some targets.
std::vector<Promise> promises_of(const OccluderScene& setup, const std::vector<double>& targets) {
    const renderer::Scene scene = setup.scene();
    const auto truths = test_support::sampled_third_bounces(setup, scene, 20'000);
    std::vector<Promise> promises;
    for (const double target : targets) {
        renderer::RenderSettings settings;
        settings.method = renderer::Estimator::ThirdBounce;
        settings.target_error = target;
        const auto result = renderer::render(scene, setup.scan, {setup.axis, {}}, settings, {});
        promises.push_back({target,
                            *result.estimated_error,
                            test_support::error_against(truths, result.capture.transient)});
    }
    return promises;
}

template <class Action>
std::string failure_of(const Action& action) {
    try {
        action();
    } catch (const core::Failure& failure) {
        return failure.what();
    }
    return "none";
}

// Shadows finer than the elements: cuts of any size take one for brighter than it is by as much.
TEST(ThirdBounceBehindOccluders, CombsAndDotsAreWithinTheTarget) {
    for (const OccluderScene& setup :
         {test_support::comb_of_thin_slats(), test_support::thousands_of_dots()}) {
        for (const Promise& promise : promises_of(setup, {0.05, 0.02})) {
            SCOPED_TRACE(testing::Message() << setup.name << " at " << promise.target);
            EXPECT_LE(promise.error, promise.target);
            EXPECT_LE(promise.reported, promise.target);
            EXPECT_LE(promise.error, 1.2 * promise.reported);
        }
    }
}

TEST(ThirdBounceBehindOccluders, RandomScenesAreWithinTheTarget) {
    constexpr std::uint64_t kScenes = 6;
    int above = 0;
    for (std::uint64_t number = 1000; number < 1000 + kScenes; ++number) {
        const OccluderScene setup = test_support::random_occluder_scene(number);
        for (const Promise& promise : promises_of(setup, {0.05, 0.02})) {
            EXPECT_LE(promise.error, 2.0 * promise.target) << setup.name;
            above += promise.error > 1.2 * promise.target;
        }
    }
    EXPECT_LE(above, 1);
}

// What rays to random points find adds up over batches before it is squared.
TEST(ThirdBounceBehindOccluders, MissedShadowsOfBatchesAddUp) {
    const OccluderScene setup = test_support::comb_of_thin_slats();
    const renderer::Scene scene = setup.scene();
    const auto missed_error = [&](std::size_t in_a_batch) {
        const renderer::CutLimits limits{.in_all = 1'000'000, .in_a_batch = in_a_batch};
        renderer::PilotRuns pilots(scene, setup.scan, setup.axis, 0.02, 0.0, limits);
        return pilots.run(0).missed_error;
    };
    const double whole = missed_error(1'000'000);
    EXPECT_GT(whole, 0.0);
    EXPECT_NEAR(missed_error(500), whole, 0.25 * whole);
}

// A wide sheet, which takes many elements, behind a small one that is black.
renderer::SceneGeometry wide_sheet() {
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(test_support::parallelogram_object(
        {Vec3(-0.5, -0.5, 0.5), Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), 0.5}));
    geometry.objects.push_back(test_support::parallelogram_object(
        {Vec3(-0.05, -0.1, 0.3), Vec3(0.15, 0.0, 0.02), Vec3(0.02, 0.2, 0.0), 0.0}));
    return geometry;
}

const renderer::CutLimits kSmallLimits{.in_all = 500'000, .in_a_batch = 100'000};

// Where the usual reference has too many elements, a nearer one serves: its error is no smaller
// than a third of the next coarser level's, and at most that.
TEST(ThirdBounceBehindOccluders, ErrorsAreKnownUpToTheLastLevelButOne) {
    const core::WallScan scan = test_support::confocal_scan({Vec3(0.0, 0.0, 0.0)});
    const renderer::Scene scene(wide_sheet(), scan, {});
    renderer::PilotRuns pilots(scene, scan, {0.9, 0.05, 20}, 1e-4, 0.0, kSmallLimits);
    const auto fits = [&](int level) { return failure_of([&] { pilots.run(level); }).empty(); };
    int last = 0;
    while (fits(last - 1)) --last;
    const double coarser = pilots.error_of(last + 2);
    const double error = pilots.error_of(last + 1);
    EXPECT_LE(error, coarser);
    EXPECT_GE(error, coarser / 3.0);
    EXPECT_FALSE(failure_of([&] { pilots.error_of(last); }).empty());
}

// The first cut already has too many elements.
TEST(ThirdBounceBehindOccluders, TargetsOutOfReachNameOneThatIsNot) {
    const core::WallScan scan = test_support::confocal_scan({Vec3(0.0, 0.0, 0.0)});
    const renderer::Scene scene(wide_sheet(), scan, {});
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::ThirdBounce;
    const core::TimeAxis axis{0.9, 0.05, 20};
    settings.target_error = 1e-5;
    const auto render = [&] {
        return integrate_third_bounce(scene, scan, axis, settings, {}, kSmallLimits);
    };
    const std::string message = failure_of(render);
    const std::string begins =
        "third_bounce: needs more than 0.5 million elements of surface: a target error ";
    ASSERT_EQ(message.substr(0, begins.size()), begins) << message;
    const double times = std::stod(message.substr(begins.size()));
    EXPECT_GT(times, 1.0);
    *settings.target_error *= times;
    EXPECT_LE(*render().estimated_error, *settings.target_error);
}

}  // namespace
