// SPDX-License-Identifier: MIT
// Sequences: the gate moves on and so do the objects.
#include "renderer/frame_sequence.h"

#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using core::Vec3;
using test_support::Parallelogram;

const Vec3 kObjectVelocity(0.4, 0.1, -0.3);

std::vector<renderer::Object> objects_after(double seconds) {
    const Vec3 way = seconds * kObjectVelocity;
    std::vector<renderer::Object> objects{
        test_support::parallelogram_object(
            {Vec3(-0.3, -0.2, 0.7) + way, Vec3(0.4, 0, 0.1), Vec3(0, 0.4, 0), 0.8}),
        test_support::parallelogram_object(
            {Vec3(-0.8, -0.8, 1.2), Vec3(1.6, 0, 0), Vec3(0, 1.6, 0), 0.6})};
    objects[0].velocity_m_per_s = kObjectVelocity;
    return objects;
}

renderer::SceneDescription description_with(const renderer::FrameSettings& frames) {
    renderer::SceneDescription description;
    description.time_axis = {1.2, 0.1, 1};
    description.frames = frames;
    description.render.method = renderer::Estimator::Path;
    description.render.max_bounces = 4;
    description.render.samples = 256;
    description.render.seed = test_support::seed_of("FrameSequence");
    return description;
}

core::Scan image_of_four_by_three() {
    core::PinholeCamera camera;
    camera.position_m = Vec3(0.1, 0.2, -0.5);
    camera.look_at_m = Vec3(0, 0, 1);
    camera.resolution = {4, 3};
    return core::ImageScan{camera};
}

renderer::RenderResult render_sequence(const core::Scan& scan,
                                       const renderer::SceneDescription& description,
                                       const core::Progress& progress = {}) {
    const auto scene = std::make_shared<const renderer::Scene>(
        renderer::SceneGeometry{objects_after(0.0), {}}, scan, description.relay_wall);
    return renderer::render_frames(scene,
                                   scan,
                                   description,
                                   renderer::make_frame_renderer(scan, description.render),
                                   progress);
}

// third_bounce is deterministic: a gate that moves by its width sees bin after bin.
TEST(FrameSequence, MovingGateSeesTheBinsOfTheHistogram) {
    auto description = description_with({8, 0.1, 0.0});
    description.render.method = renderer::Estimator::ThirdBounce;
    description.render.max_bounces = 3;
    description.render.target_error = 0.01;
    const core::Scan scan = test_support::confocal_scan(test_support::kThreeWallPoints);
    const auto sequence = *render_sequence(scan, description).capture.sequence;
    ASSERT_EQ(sequence.frames.size(), 8U);
    EXPECT_EQ(sequence.gate_step_m, 0.1);

    const renderer::Scene scene({objects_after(0.0), {}}, scan, {});
    const auto histogram =
        renderer::render(scene, scan, core::TimeAxis{1.2, 0.1, 8}, description.render, {}).capture;
    const float largest =
        *std::max_element(histogram.transient.values().begin(), histogram.transient.values().end());
    for (std::size_t frame = 0; frame < 8; ++frame) {
        for (std::size_t pair = 0; pair < 3; ++pair) {
            EXPECT_NEAR(sequence.frames[frame].histogram(pair)[0],
                        histogram.transient.histogram(pair)[frame],
                        0.03F * largest)
                << "frame " << frame << " pair " << pair;
        }
    }
}

// Frame i is what a scene with the objects moved gives, to the bit, for scans and for cameras.
TEST(FrameSequence, FramesAreRendersOfTheMovedScene) {
    for (const core::Scan& scan :
         {core::Scan(test_support::confocal_scan(test_support::kThreeWallPoints)),
          image_of_four_by_three()}) {
        auto description = description_with({3, 0.05, 0.25});
        description.time_axis.bin_width_m = 1.8;
        std::vector<renderer::Frame> seen;
        const auto scene = std::make_shared<const renderer::Scene>(
            renderer::SceneGeometry{objects_after(0.0), {}}, scan, description.relay_wall);
        const auto plain = renderer::make_frame_renderer(scan, description.render);
        const auto result = renderer::render_frames(
            scene,
            scan,
            description,
            [&](const renderer::Frame& frame, const core::Scan& s, const core::Progress& p) {
                seen.push_back(frame);
                return plain(frame, s, p);
            },
            {});
        ASSERT_EQ(seen.size(), 3U);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(seen[i].index, static_cast<int>(i));
            const double seconds = 0.25 * static_cast<double>(i);
            const renderer::Scene moved({objects_after(seconds), {}}, scan, description.relay_wall);
            EXPECT_LT((seen[i].scene->facet(0).corner - moved.facet(0).corner).norm(), 1e-12);
            core::TimeAxis axis = description.time_axis;
            axis.opl_start_m += 0.05 * static_cast<double>(i);
            EXPECT_EQ(seen[i].axes.time.opl_start_m, axis.opl_start_m);
            const auto alone = renderer::render(moved, scan, axis, seen[i].settings, {});
            EXPECT_LT(test_support::relative_l2(result.capture.sequence->frames[i].values(),
                                                alone.capture.transient.values()),
                      1e-6);
        }
        EXPECT_EQ(result.capture.time_axis.opl_start_m, seen[2].axes.time.opl_start_m);
        EXPECT_TRUE(std::ranges::equal(result.capture.transient.values(),
                                       result.capture.sequence->frames[2].values()));
    }
}

TEST(FrameSequence, FirstFrameIsTheRenderWithoutFramesAndNoiseIsNew) {
    const core::Scan scan = image_of_four_by_three();
    auto description = description_with({4, 0.0, 0.0});
    description.time_axis = {0.0, 20.0, 1};
    const auto frames = render_sequence(scan, description).capture.sequence->frames;
    const renderer::Scene scene({objects_after(0.0), {}}, scan, {});
    const auto alone = renderer::render(scene, scan, description.time_axis, description.render, {});
    EXPECT_TRUE(std::ranges::equal(frames[0].values(), alone.capture.transient.values()));
    EXPECT_NE(frames[1].values()[0], frames[0].values()[0]);
    // Another seed's frames are none of this one's, shifted.
    description.render.seed += 1;
    const auto others = render_sequence(scan, description).capture.sequence->frames;
    for (const core::Transient& a : frames) {
        for (const core::Transient& b : others) EXPECT_NE(a.values()[0], b.values()[0]);
    }
}

TEST(FrameSequence, InterruptionKeepsTheFramesSoFar) {
    int frames_done = 0;
    core::Progress progress;
    progress.report = [&](double fraction, const std::string&) {
        frames_done = static_cast<int>(fraction * 5.0 + 1e-9);
    };
    progress.stop_requested = [&] { return frames_done >= 2; };
    const auto result =
        render_sequence(image_of_four_by_three(), description_with({5, 0.1, 0.0}), progress);
    EXPECT_TRUE(result.interrupted);
    EXPECT_GE(result.capture.sequence->frames.size(), 2U);
    EXPECT_LT(result.capture.sequence->frames.size(), 5U);
}

}  // namespace
