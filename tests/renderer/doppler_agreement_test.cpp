// SPDX-License-Identifier: MIT
// Spectra of path velocities between estimators.
#include "renderer/frame_sequence.h"
#include "tests/renderer/doppler_scenes.h"
#include "tests/support/repeated_estimates.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace {

using doppler_test::doppler_settings;
using doppler_test::four_points;
using doppler_test::moving_scene;
using doppler_test::nine_pixels;
using renderer::Estimator;

struct Measured {
    const char* name;
    core::Scan scan;
    core::HistogramAxes axes;
    int max_bounces;
};

std::vector<Measured> measured() {
    const core::VelocityAxis alone{-12.0, 1.5, 16};
    const core::VelocityAxis joint{-12.0, 3.0, 8, true};
    return {{"scan", four_points(core::ScanPattern::Confocal), {{1.2, 0.9, 2}, alone}, 5},
            {"scan_with_time", four_points(core::ScanPattern::Single), {{1.2, 0.3, 6}, joint}, 4},
            {"image", nine_pixels(), {{1.8, 1.0, 2}, alone}, 4},
            {"image_with_time", nine_pixels(), {{1.8, 0.5, 4}, joint}, 3}};
}

class DopplerIn : public testing::TestWithParam<std::size_t> {};

TEST_P(DopplerIn, EstimatorsAgreeBinByBin) {
    const Measured setting = measured()[GetParam()];
    const renderer::Scene scene = moving_scene(setting.scan);
    const auto estimate = [&](const std::string& name, renderer::RenderSettings settings) {
        settings.max_bounces = setting.max_bounces;
        settings.variance = false;
        return test_support::repeat(
            [&](std::uint64_t seed) {
                settings.seed = seed;
                const auto capture =
                    renderer::render(scene, setting.scan, setting.axes, settings, {}).capture;
                test_support::Numbers numbers = test_support::sums_of(capture.transient);
                const auto more = test_support::sums_of(capture.velocity->values);
                numbers.insert(numbers.end(), more.begin(), more.end());
                return numbers;
            },
            std::string("Doppler.") + setting.name + name);
    };
    const auto paths = estimate("paths", doppler_settings(Estimator::Path, 8192, 3));
    const auto expect_the_same = [&](const std::string& name,
                                     const renderer::RenderSettings& settings) {
        SCOPED_TRACE(name);
        test_support::expect_same_means(estimate(name, settings), paths, 0.04);
    };
    expect_the_same("ellipsoidal", doppler_settings(Estimator::Ellipsoidal, 2048, 3));
    renderer::RenderSettings restir = doppler_settings(Estimator::Restir, 1040, 3);
    expect_the_same("restir", restir);
    restir.restir.rounds = 4;
    expect_the_same("rounds", restir);
    restir.restir.rounds = 1;
    restir.restir.chart = renderer::Chart::Hemisphere;
    expect_the_same("hemisphere", restir);
    restir.restir.chart = renderer::Chart::Plane;
    restir.restir.candidates = renderer::Candidates::Ellipsoidal;
    restir.restir.walks = 16;
    expect_the_same("plane", restir);
    restir.restir.reuse = renderer::Reuse::Naive;
    expect_the_same("naive", restir);
}

INSTANTIATE_TEST_SUITE_P(Measurements,
                         DopplerIn,
                         testing::Range<std::size_t>(0, 4),
                         [](const auto& test) { return measured()[test.param].name; });

// Objects move on between the frames, and paths with them.
TEST(Doppler, FramesOfResampledPathsAgreeWithPathTracing) {
    const core::Scan scan = four_points(core::ScanPattern::Confocal);
    renderer::SceneDescription description;
    description.time_axis = {1.2, 1.2, 1};
    description.velocity_axis = core::VelocityAxis{-12.0, 2.0, 12};
    description.frames = {5, 0.01, 0.005};
    const auto sequence = [&](Estimator method, int samples) {
        description.render = doppler_settings(method, samples, 4);
        return test_support::repeat(
            [&](std::uint64_t seed) {
                description.render.seed = seed;
                const auto scene = std::make_shared<const renderer::Scene>(moving_scene(scan));
                const auto result =
                    renderer::render_frames(scene,
                                            scan,
                                            description,
                                            renderer::make_frame_renderer(scan, description.render),
                                            {});
                return test_support::sums_of(result.capture.velocity->values);
            },
            "Doppler.Frames");
    };
    test_support::expect_same_means(
        sequence(Estimator::Restir, 1040), sequence(Estimator::Path, 8192), 0.04);
}

}  // namespace
