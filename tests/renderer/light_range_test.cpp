// SPDX-License-Identifier: MIT
#include "renderer/light_range.h"

#include "renderer/core/capture/instrument_response.h"
#include "renderer/render.h"
#include "tests/support/error_message.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <numeric>

namespace {

using core::Vec3;

renderer::SceneDescription description_of(const core::TimeAxis& axis = {}) {
    renderer::SceneDescription description;
    description.time_axis = {axis};
    return description;
}

// Wall points on a grid of the plane z = 0, one metre wide.
core::Scan grid_scan(int side) {
    renderer::SceneDescription description;
    description.scan.sensing_points = {side, side};
    return renderer::make_scan(description);
}

renderer::Scene panel_scene(const core::Scan& scan, const Vec3& moved = Vec3::Zero()) {
    test_support::Parallelogram panel = test_support::kTiltedPanel;
    panel.corner += moved;
    return {{{test_support::parallelogram_object(panel)}, {}}, scan, {}};
}

double light_on(const core::TimeAxis& axis, const renderer::Scene& scene, const core::Scan& scan) {
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::Path;
    const auto result = renderer::render(scene, scan, {axis, {}}, settings, {});
    const auto values = result.capture.transient.values();
    return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(LightRange, IsThatOfAPatchBeforeTheWall) {
    const core::Scan scan = test_support::confocal_scan({Vec3::Zero()});
    const renderer::Scene scene(
        {{test_support::parallelogram_object({{-0.01, -0.01, 0.7}, {0.02, 0, 0}, {0, 0.02, 0}})},
         {}},
        scan,
        {});
    const auto range = renderer::find_light_range(scene, scan, {});
    ASSERT_TRUE(range);
    const double corner = 2.0 * std::hypot(0.01, 0.01, 0.7);
    EXPECT_NEAR(range->possible_m[0], 1.4, 1e-5);
    EXPECT_NEAR(range->possible_m[1], corner, 1e-12);
    const auto [first, last] = range->without_tails(0.0);
    EXPECT_LE(first, 1.4);
    EXPECT_GE(last, corner - 1e-4);
    EXPECT_NEAR(range->fraction_between(1.3, 1.5), 1.0, 1e-12);
    EXPECT_EQ(range->fraction_between(1.5, 2.0), 0.0);
}

TEST(LightRange, AutomaticAxesHoldAllThirdBounces) {
    const core::TimeAxis wide{0.0, 0.01, 1000};
    for (const Vec3& moved : {Vec3(0, 0, 0), Vec3(0.5, -0.3, 0.4), Vec3(0, 0, 2.0)}) {
        const core::Scan scan = grid_scan(12);
        const renderer::Scene scene = panel_scene(scan, moved);
        const auto range = renderer::find_light_range(scene, scan, {});
        const core::TimeAxis axis =
            renderer::choose_time_axis(range, scene, scan, description_of());
        EXPECT_NEAR(light_on(axis, scene, scan) / light_on(wide, scene, scan), 1.0, 1e-6);
        EXPECT_GE(axis.num_bins, 60);  // 64 before the width is rounded up
        EXPECT_LE(axis.num_bins, 4097);
        EXPECT_TRUE(renderer::axis_warnings(*range, axis, {}).empty());
    }
}

TEST(LightRange, StatedBinsOfAnAutomaticAxisStay) {
    const core::TimeAxis wide{0.0, 0.01, 1000};
    const core::Scan scan = grid_scan(12);
    const renderer::Scene scene = panel_scene(scan);
    const auto range = renderer::find_light_range(scene, scan, {});
    renderer::SceneDescription description = description_of({0.0, 0.0029979, 512});
    description.time_axis.stated.bin_width = true;
    const core::TimeAxis fine = renderer::choose_time_axis(range, scene, scan, description);
    EXPECT_EQ(fine.bin_width_m, 0.0029979);
    EXPECT_NEAR(light_on(fine, scene, scan) / light_on(wide, scene, scan), 1.0, 1e-6);
    EXPECT_LT(fine.num_bins * fine.bin_width_m,
              1.1 * (range->possible_m[1] - range->possible_m[0]));
    description.time_axis.stated.num_bins = true;
    EXPECT_EQ(renderer::choose_time_axis(range, scene, scan, description).num_bins, 512);
}

TEST(LightRange, AutomaticBinsAreFineEnoughForTheDetector) {
    const core::Scan scan = grid_scan(12);
    const renderer::Scene scene = panel_scene(scan);
    const auto range = renderer::find_light_range(scene, scan, {});
    renderer::SceneDescription description = description_of();
    const double usual = renderer::choose_time_axis(range, scene, scan, description).bin_width_m;
    description.detector = renderer::SceneDetector{60.0};
    const core::TimeAxis fine = renderer::choose_time_axis(range, scene, scan, description);
    EXPECT_LT(fine.bin_width_m, usual);
    EXPECT_LE(fine.bin_width_m, 0.5 * core::sigma_m_from_fwhm_ps(60.0));
    description.detector = renderer::SceneDetector{6000.0};
    EXPECT_EQ(renderer::choose_time_axis(range, scene, scan, description).bin_width_m, usual);
}

TEST(LightRange, AutomaticAxesScaleWithTheScene) {
    std::vector<int> counts;
    for (const double scale : {1e-3, 1.0, 1e3}) {
        renderer::SceneDescription description = description_of();
        description.relay_wall.size_m = {scale, scale};
        description.scan.sensing_points = {16, 16};
        const core::Scan scan = renderer::make_scan(description);
        renderer::Object panel = test_support::parallelogram_object(test_support::kTiltedPanel);
        for (Vec3& vertex : panel.mesh.vertices) vertex *= scale;
        const renderer::Scene scene({{panel}, {}}, scan, description.relay_wall);
        const auto range = renderer::find_light_range(scene, scan, {});
        counts.push_back(renderer::choose_time_axis(range, scene, scan, description).num_bins);
    }
    EXPECT_NEAR(counts[0], counts[1], 0.1 * counts[1]);
    EXPECT_NEAR(counts[2], counts[1], 0.1 * counts[1]);
}

TEST(LightRange, AutomaticAxesFollowObjectsThatMove) {
    renderer::Object panel = test_support::parallelogram_object(test_support::kTiltedPanel);
    panel.velocity_m_per_s = Vec3(0, 0, 1.0);
    const core::Scan scan = grid_scan(4);
    const renderer::Scene scene({{panel}, {}}, scan, {});
    renderer::SceneDescription description = description_of();
    const auto range = renderer::find_light_range(scene, scan, {});
    const double at_rest = renderer::choose_time_axis(range, scene, scan, description).opl_end_m();
    description.frames = renderer::FrameSettings{11, 0.0, 0.1};
    const double moving = renderer::choose_time_axis(range, scene, scan, description).opl_end_m();
    EXPECT_GT(moving, at_rest + 1.7);
}

TEST(LightRange, AxesThatMissTheLightAreNamedWithBothRanges) {
    const core::Scan scan = grid_scan(4);
    const renderer::Scene scene = panel_scene(scan);
    const auto range = renderer::find_light_range(scene, scan, {});
    ASSERT_TRUE(range);
    const auto warnings = [&](const core::TimeAxis& axis,
                              const std::optional<renderer::FrameSettings>& frames = {}) {
        const auto texts = renderer::axis_warnings(*range, axis, frames);
        return texts.empty() ? std::string() : texts.front();
    };
    EXPECT_EQ(warnings({0.0, 0.01, 512}), "");
    const std::string late = warnings({30.0, 0.01, 512});
    EXPECT_NE(late.find("30 to 35.12 m and no light: paths are 1."), std::string::npos) << late;
    EXPECT_NE(late.find("time_axis=auto"), std::string::npos) << late;
    EXPECT_NE(warnings({0.0, 0.001, 64}).find("no light"), std::string::npos);
    // A little of it; a gate is meant to hold little; frames may reach it later.
    EXPECT_NE(warnings({0.0, 0.01, 160}).find("% of the light"), std::string::npos);
    EXPECT_EQ(warnings({1.6, 0.01, 1}), "");
    EXPECT_NE(warnings({0.5, 0.01, 1}).find("no light"), std::string::npos);
    EXPECT_EQ(warnings({0.5, 0.01, 1}, renderer::FrameSettings{150, 0.01, 0.0}), "");
}

TEST(LightRange, ScenesWithoutLightSaySo) {
    const core::Scan scan = grid_scan(4);
    test_support::Parallelogram black = test_support::kTiltedPanel;
    black.albedo = 0.0;
    const renderer::Scene scene({{test_support::parallelogram_object(black)}, {}}, scan, {});
    const auto range = renderer::find_light_range(scene, scan, {});
    ASSERT_TRUE(range);
    EXPECT_TRUE(range->is_dark());
    EXPECT_EQ(renderer::axis_warnings(*range, {}, {}).size(), 1U);
    EXPECT_ERROR_WITH(renderer::choose_time_axis(range, scene, scan, description_of()),
                      "no light reaches the scan");
}

TEST(LightRange, ImagesAreCoveredToo) {
    core::PinholeCamera camera;
    camera.position_m = Vec3(0.0, 0.0, -1.0);
    camera.look_at_m = Vec3(0.0, 0.0, 1.0);
    camera.resolution = {8, 8};
    const core::Scan scan = test_support::image_of(camera);
    const renderer::Scene scene({test_support::facing_surfaces(), {}}, scan, {});
    const auto range = renderer::find_light_range(scene, scan, {});
    ASSERT_TRUE(range);
    ASSERT_FALSE(range->is_dark());
    renderer::SceneDescription description = description_of();
    const core::TimeAxis axis = renderer::choose_time_axis(range, scene, scan, description);
    EXPECT_NEAR(light_on(axis, scene, scan) / light_on({0.0, 0.05, 400}, scene, scan), 1.0, 0.02);
}

}  // namespace
