// SPDX-License-Identifier: MIT
// Retroreflectors return light to where it came from: to confocal pairs of any scan, no others.
#include "renderer/render.h"
#include "renderer/scene/coinciding_points.h"
#include "renderer/third_bounce/pilot_runs.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <array>
#include <span>

namespace {

using core::Vec3;
using renderer::CoincidingPoints;

const Vec3 kA(-0.3, 0.1, 0.0);
const Vec3 kB(0.0, 0.0, 0.0);
const Vec3 kC(0.35, -0.25, 0.0);
const core::TimeAxis kRetroAxis{0.8, 0.02, 60};

renderer::Scene scene_of(const core::WallScan& scan) {
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(test_support::parallelogram_object(test_support::kTiltedPanel));
    geometry.objects.back().material.model = renderer::model_of({.retroreflective = true});
    return {std::move(geometry), scan, renderer::RelayWall{}};
}

core::Transient render(const core::WallScan& scan, double target_error) {
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::ThirdBounce;
    settings.target_error = target_error;
    return renderer::render(scene_of(scan), scan, kRetroAxis, settings, {}).capture.transient;
}

TEST(Retroreflectors, ReturnLightToConfocalPairsOfExhaustiveScans) {
    const core::Transient exhaustive =
        render(test_support::exhaustive_scan({kA, kB}, {kC, kB, kA}), 1e-3);
    const core::Transient confocal = render(test_support::confocal_scan({kA, kB}), 1e-3);
    constexpr std::array<std::size_t, 2> kPairs{2, 4};  // (A, A) and (B, B)
    for (std::size_t i = 0; i < kPairs.size(); ++i) {
        EXPECT_GT(test_support::sum_of(confocal.histogram(i)), 0.0);
        EXPECT_LT(test_support::relative_l2(exhaustive.histogram(kPairs[i]), confocal.histogram(i)),
                  2e-3);
    }
    for (const std::size_t pair : {0U, 1U, 3U, 5U}) {
        EXPECT_EQ(test_support::sum_of(exhaustive.histogram(pair)), 0.0) << "pair " << pair;
    }
}

TEST(Retroreflectors, ReturnLightToTheLaserPointOfSingleScans) {
    const core::Transient single = render(test_support::single_scan(kB, {kA, kB, kC}), 1e-3);
    const core::Transient confocal = render(test_support::confocal_scan({kB}), 1e-3);
    EXPECT_LT(test_support::relative_l2(single.histogram(1), confocal.histogram(0)), 2e-3);
    EXPECT_EQ(test_support::sum_of(single.histogram(0)), 0.0);
    EXPECT_EQ(test_support::sum_of(single.histogram(2)), 0.0);
}

TEST(Retroreflectors, AddAsMuchAsPathsDo) {
    const core::WallScan scan = test_support::exhaustive_scan({kA, kB}, {kC, kB, kA});
    const core::Transient integrated = render(scan, 1e-3);
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::Path;
    settings.samples = 40'000;
    settings.seed = test_support::seed_of("AddAsMuchAsPathsDo");
    const auto paths = renderer::render(scene_of(scan), scan, kRetroAxis, settings, {});
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        const double sum = test_support::sum_of(paths.capture.transient.histogram(pair));
        EXPECT_NEAR(test_support::sum_of(integrated.histogram(pair)), sum, 0.01 * sum)
            << "pair " << pair;
    }
}

// Of many points of a grid, only some are tried.
TEST(Retroreflectors, AreTriedInAPairThatSeesThem) {
    std::vector<Vec3> points;
    for (int i = 0; i < 200; ++i) points.emplace_back(0.005 * i - 0.5, 0.0, 0.0);
    const auto is_tried = [](const core::WallScan& scan) {
        return CoincidingPoints(renderer::pilot_scan_for(scene_of(scan), scan, kRetroAxis.num_bins))
            .any();
    };
    for (const std::size_t light : {0U, 17U, 199U}) {
        EXPECT_TRUE(is_tried(test_support::single_scan(points[light], points)));
        EXPECT_TRUE(is_tried(test_support::exhaustive_scan({kC, points[light]}, points)));
    }
    EXPECT_FALSE(is_tried(test_support::single_scan(kC, points)));
}

TEST(CoincidingPoints, AreThoseOfBothListsWithTheSameNormals) {
    core::WallScan scan = test_support::exhaustive_scan({kA, kB, kB}, {kB, kC});
    const CoincidingPoints found(scan);
    EXPECT_EQ(found.illumination, (std::vector<bool>{false, true, true}));
    EXPECT_EQ(found.sensing, (std::vector<bool>{true, false}));
    scan.sensing.normals[0] = Vec3(0.6, 0.0, 0.8);
    EXPECT_FALSE(CoincidingPoints(scan).any());
    EXPECT_TRUE(CoincidingPoints(test_support::confocal_scan({kA})).any());
}

}  // namespace
