// SPDX-License-Identifier: MIT
// Paths of earlier frames, reused where objects move apart: sums over a gate against path tracing.
#include "renderer/frame_sequence.h"
#include "tests/support/repeated_estimates.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <string>

namespace {

using core::Vec3;
using renderer::Chart;
using renderer::Estimator;
using test_support::Estimate;
using test_support::Numbers;

// Three balls, each with a motion of its own. Shifts by ray find other balls than the one they
// start from.
struct BallsMovingApart {
    core::WallScan scan = [] {
        std::vector<Vec3> points;
        for (int i = 0; i < 9; ++i) {
            points.emplace_back(-0.3 + 0.2 * (i % 3), -0.2 + 0.2 * (i / 3), 0.0);
        }
        return test_support::confocal_scan(points);
    }();
    renderer::SceneDescription description = [] {
        renderer::SceneDescription result;
        result.time_axis = {1.7, 0.1, 1};
        result.frames = {6, /*gate_step_m=*/0.01, /*frame_s=*/0.1};
        result.render.max_bounces = 4;
        result.render.restir.shared_walks = 64;
        result.render.restir.neighbours = 2;
        return result;
    }();
    std::shared_ptr<const renderer::Scene> scene = [this] {
        renderer::SceneGeometry geometry;
        geometry.objects = {test_support::sphere_object(Vec3(-0.1, 0.0, 0.8), 0.18, 2, 0.8),
                            test_support::sphere_object(Vec3(0.25, 0.1, 0.9), 0.15, 2, 0.7),
                            test_support::sphere_object(Vec3(0.0, 0.0, 0.4), 0.05, 2, 0.5)};
        geometry.objects[0].velocity_m_per_s = Vec3(0.0, 0.1, -0.2);
        geometry.objects[1].velocity_m_per_s = Vec3(-0.2, 0.0, 0.1);
        geometry.objects[2].velocity_m_per_s = Vec3(0.2, 0.0, 0.0);
        return std::make_shared<const renderer::Scene>(
            std::move(geometry), scan, description.relay_wall);
    }();

    // Totals of every frame and of all of them, each the mean over several renders.
    Numbers totals(const renderer::RenderSettings& settings) const {
        constexpr int kRenders = 12;
        Numbers numbers(static_cast<std::size_t>(description.frames->count) + 1);
        renderer::SceneDescription described = description;
        described.render = settings;
        for (std::uint64_t i = 0; i < kRenders; ++i) {
            described.render.seed = kRenders * settings.seed + i;
            const auto result = renderer::render_frames(
                scene, scan, described, renderer::make_frame_renderer(scan, described.render), {});
            const auto& frames = result.capture.sequence->frames;
            for (std::size_t frame = 0; frame < frames.size(); ++frame) {
                const double total = test_support::sums_of(frames[frame]).back() / kRenders;
                numbers[frame] += total;
                numbers.back() += total;
            }
        }
        return numbers;
    }
    Estimate estimate(Estimator method, int samples, Chart chart, const std::string& name) const {
        renderer::RenderSettings settings = description.render;
        settings.method = method;
        settings.samples = samples;
        settings.restir.chart = chart;
        return test_support::repeat(
            [&](std::uint64_t seed) {
                settings.seed = seed;
                return totals(settings);
            },
            name);
    }
};

TEST(RestirOfMovingObjects, EveryFrameAgreesWithPathTracing) {
    const BallsMovingApart balls;
    const Estimate paths =
        balls.estimate(Estimator::Path, 2048, Chart::Adaptive, "RestirOfMovingObjects.Paths");
    for (const Chart chart : {Chart::Adaptive, Chart::Plane, Chart::Hemisphere}) {
        const std::string name(core::enum_name(chart));
        SCOPED_TRACE(name);
        test_support::expect_same_means(
            balls.estimate(Estimator::Restir, 65, chart, "RestirOfMovingObjects." + name),
            paths,
            0.03);
    }
}

}  // namespace
