// SPDX-License-Identifier: MIT
#include "nlos/pictures/animation.h"

#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace nlos {
namespace {

float light_of(const ImagePanel& panel) {
    return std::accumulate(panel.values.begin(), panel.values.end(), 0.0F);
}

TEST(Animation, ShowsEveryBinOnOneScale) {
    for (const core::Capture& capture : {test_support::example_capture(core::ScanPattern::Confocal),
                                         test_support::example_image()}) {
        const std::vector<ImagePanel> frames = animation_panels(capture, 300);
        ASSERT_EQ(frames.size(), 5U);
        float total = 0.0F;
        for (const ImagePanel& frame : frames) {
            total += light_of(frame);
            EXPECT_EQ(frame.value_range, frames[0].value_range);
            EXPECT_EQ(frame.value_scale, ValueScale::Gamma);
        }
        const auto& values = capture.transient.values();
        EXPECT_FLOAT_EQ(total, std::accumulate(values.begin(), values.end(), 0.0F));
    }
}

TEST(Animation, TellsTheTime) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    capture.time_axis = {2.99792458, 0.0299792458, 5};
    EXPECT_EQ(animation_panels(capture, 300)[0].title, "Path length 3.013 m, 10.050 ns");
}

TEST(Animation, LeavesDarkEndsOut) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    capture.time_axis.num_bins = 100;
    capture.transient = core::Transient(capture.scan.num_pairs(), 100);
    for (std::size_t bin = 40; bin < 50; ++bin) capture.transient.histogram(0)[bin] = 1.0F;
    const std::vector<ImagePanel> frames = animation_panels(capture, 300);
    EXPECT_GE(frames.size(), 10U);
    EXPECT_LE(frames.size(), 20U);
}

TEST(Animation, BinsShareFramesWhereTheyAreTooMany) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    const std::vector<ImagePanel> frames = animation_panels(capture, 2);
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_FLOAT_EQ(frames[0].values[0],
                    capture.transient.histogram(0)[0] + capture.transient.histogram(0)[1] +
                        capture.transient.histogram(0)[2]);
}

TEST(Animation, ExhaustiveScansShowTheMiddleLitPoint) {
    const core::Capture capture = test_support::example_capture(core::ScanPattern::Exhaustive);
    // Lit point 2 of 4, the first of 6 sensing points.
    EXPECT_FLOAT_EQ(animation_panels(capture, 300)[0].values[0],
                    capture.transient.histogram(2 * 6)[0]);
}

TEST(Animation, ScansWithMoreLitThanSensingPointsShowTheLitOnes) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Exhaustive);
    std::swap(capture.scan.wall().sensing, capture.scan.wall().illumination);
    const std::vector<ImagePanel> frames = animation_panels(capture, 300);
    ASSERT_EQ(frames[0].values.size(), 6U);
    for (std::size_t lit = 0; lit < 6; ++lit) {  // sensing point 2 of 4
        const float light = capture.transient.histogram(4 * lit + 2)[0];
        EXPECT_EQ(std::ranges::count(frames[0].values, light), 1);
    }
}

TEST(Animation, SequencesAreShownFrameByFrame) {
    core::Capture capture = test_support::example_image();
    core::FrameSequence sequence;
    sequence.frames.assign(30, capture.transient);
    capture.sequence = sequence;
    EXPECT_EQ(animation_panels(capture, 300).size(), 30U);
    EXPECT_EQ(animation_panels(capture, 10).size(), 10U);
}

TEST(Animation, NeedsAnImageAndTime) {
    core::Capture list = test_support::example_capture(core::ScanPattern::Confocal);
    list.scan.wall().sensing.grid.reset();
    list.scan.wall().illumination.grid.reset();
    EXPECT_ERROR_WITH(animation_panels(list, 300), "a list of points");
    core::Capture gate = test_support::example_capture(core::ScanPattern::Confocal);
    gate.time_axis.num_bins = 1;
    gate.transient = core::Transient(gate.scan.num_pairs(), 1);
    EXPECT_ERROR_WITH(animation_panels(gate, 300), "one time bin");
}

}  // namespace
}  // namespace nlos
