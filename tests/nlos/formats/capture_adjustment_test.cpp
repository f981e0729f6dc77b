// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_file.h"
#include "renderer/core/capture/capture.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

using core::Capture;
using core::ScanPattern;
using core::Vec3;
using test_support::example_capture;

Capture adjusted(const Capture& capture, const CaptureReadSettings& settings) {
    return adjust_capture(capture, settings, "file");
}

std::vector<float> histogram_of(const core::Transient& transient, std::size_t pair) {
    const auto histogram = transient.histogram(pair);
    return {histogram.begin(), histogram.end()};
}

TEST(CaptureAdjustment, WithoutSettingsNothingChanges) {
    const Capture capture = example_capture(ScanPattern::Exhaustive);
    const Capture same = adjusted(capture, {});
    EXPECT_TRUE(std::ranges::equal(same.transient.values(), capture.transient.values()));
    EXPECT_EQ(same.scan.wall().sensing.positions, capture.scan.wall().sensing.positions);
    EXPECT_EQ(same.notes, capture.notes);
}

TEST(CaptureAdjustment, EachSettingLeavesANote) {
    const Capture capture = example_capture(ScanPattern::Confocal);
    const auto notes = [&](auto&& set) {
        CaptureReadSettings settings;
        set(settings);
        return adjusted(capture, settings).notes.size();
    };
    EXPECT_EQ(notes([](auto& s) { s.wall_size_m = {1.0, 1.0}; }), 1U);
    EXPECT_EQ(notes([](auto& s) { s.opl_origin = core::OplOrigin::Device; }), 1U);
    EXPECT_EQ(notes([](auto& s) { s.unit = core::TransientUnit::Counts; }), 1U);
    EXPECT_EQ(notes([](auto& s) { s.swap_xy = s.flip_x = s.flip_y = true; }), 1U);
    EXPECT_EQ(notes([](auto& s) { s.flip_t = true; }), 1U);
    EXPECT_EQ(notes([](auto& s) { s.opl_shift_m = 0.5; }), 1U);
}

TEST(CaptureAdjustment, WallSizeStretchesAroundTheMiddle) {
    CaptureReadSettings settings;
    settings.wall_size_m = {0.4, 0.3};  // from 0.2 and 0.1
    const Capture capture = example_capture(ScanPattern::Confocal);
    const Capture wider = adjusted(capture, settings);
    const core::ScanExtent extent = core::scan_extent(wider.scan.wall());
    EXPECT_NEAR(extent.size_m[0], 0.4, 1e-12);
    EXPECT_NEAR(extent.size_m[1], 0.3, 1e-12);
    EXPECT_LT((wider.scan.wall().sensing.positions[0] - Vec3(-0.2, 0.1, 0.0)).norm(), 1e-12);
    EXPECT_EQ(wider.scan.wall().sensing.positions, wider.scan.wall().illumination.positions);
    EXPECT_EQ(wider.scan.wall().sensing.grid, capture.scan.wall().sensing.grid);
}

TEST(CaptureAdjustment, WallSizeFollowsATurnedGridAndLeavesALoneSpot) {
    Capture capture = example_capture(ScanPattern::Single);
    const core::Transform turn(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -1.0).normalized()));
    for (Vec3& position : capture.scan.wall().sensing.positions) position = turn * position;
    CaptureReadSettings settings;
    settings.wall_size_m = {0.4, 0.1};
    const Capture wider = adjusted(capture, settings);
    EXPECT_LT((wider.scan.wall().sensing.positions[0] - turn * Vec3(-0.2, 0.2, 0.0)).norm(), 1e-12);
    EXPECT_LT((wider.scan.wall().sensing.positions[5] - turn * Vec3(0.2, 0.3, 0.0)).norm(), 1e-12);
    EXPECT_EQ(wider.scan.wall().illumination.positions, capture.scan.wall().illumination.positions);
}

TEST(CaptureAdjustment, WallSizeStretchesBothListsOfAnExhaustiveScanAlike) {
    CaptureReadSettings settings;
    settings.wall_size_m = {0.4, 0.2};  // twice as large around (0, 0.25)
    const Capture wider = adjusted(example_capture(ScanPattern::Exhaustive), settings);
    EXPECT_LT((wider.scan.wall().illumination.positions[0] - Vec3(0.6, 0.15, 0.0)).norm(), 1e-12);
    EXPECT_LT((wider.scan.wall().illumination.positions[3] - Vec3(0.8, 0.35, 0.0)).norm(), 1e-12);
}

TEST(CaptureAdjustment, AnAxisWithoutExtentStays) {
    Capture capture = example_capture(ScanPattern::Confocal);
    for (core::WallPoints* points :
         {&capture.scan.wall().sensing, &capture.scan.wall().illumination}) {
        *points = test_support::example_grid(6, 1);
    }
    CaptureReadSettings settings;
    settings.wall_size_m = {1.0, 7.0};
    const core::ScanExtent extent = core::scan_extent(adjusted(capture, settings).scan.wall());
    EXPECT_NEAR(extent.size_m[0], 1.0, 1e-12);
    EXPECT_EQ(extent.size_m[1], 0.0);
}

TEST(CaptureAdjustment, FlipsMoveHistogramsToTheOtherSide) {
    const Capture capture = example_capture(ScanPattern::Single);  // 3 x 2 points
    CaptureReadSettings settings;
    settings.flip_x = true;
    const Capture in_x = adjusted(capture, settings);
    EXPECT_EQ(histogram_of(in_x.transient, 0), histogram_of(capture.transient, 4));
    EXPECT_EQ(histogram_of(in_x.transient, 3), histogram_of(capture.transient, 3));
    EXPECT_EQ(in_x.scan.wall().sensing.positions, capture.scan.wall().sensing.positions);
    settings.flip_x = false;
    settings.flip_y = true;
    const Capture in_y = adjusted(capture, settings);
    EXPECT_EQ(histogram_of(in_y.transient, 0), histogram_of(capture.transient, 1));
    EXPECT_EQ(histogram_of(in_y.transient, 5), histogram_of(capture.transient, 4));
}

TEST(CaptureAdjustment, SwapReadsTheGridInTheOtherOrder) {
    const Capture capture = example_capture(ScanPattern::Confocal);  // 3 x 2 points
    CaptureReadSettings settings;
    settings.swap_xy = true;
    const Capture swapped = adjusted(capture, settings);
    const std::array<std::size_t, 6> stored{0, 3, 1, 4, 2, 5};  // [y][x] of 2 x 3
    for (std::size_t pair = 0; pair < 6; ++pair) {
        EXPECT_EQ(histogram_of(swapped.transient, pair),
                  histogram_of(capture.transient, stored[pair]));
    }
    settings.flip_x = true;
    EXPECT_EQ(histogram_of(adjusted(capture, settings).transient, 0),
              histogram_of(swapped.transient, 4));
}

TEST(CaptureAdjustment, ExhaustiveScansMoveAmongBothListsOfPoints) {
    const Capture capture = example_capture(ScanPattern::Exhaustive);  // 2 x 2 lit, 3 x 2 sensed
    CaptureReadSettings settings;
    settings.flip_x = true;
    const Capture flipped = adjusted(capture, settings);
    EXPECT_EQ(histogram_of(flipped.transient, 0), histogram_of(capture.transient, 2 * 6 + 4));
    EXPECT_EQ(histogram_of(flipped.transient, 6 + 3), histogram_of(capture.transient, 3 * 6 + 3));
}

TEST(CaptureAdjustment, EverythingThatBelongsToAPairMovesAlong) {
    Capture capture = example_capture(ScanPattern::Confocal);
    capture.variance = capture.transient;
    capture.by_order = {capture.transient};
    capture.orders = {3};
    capture.sequence = core::FrameSequence{{capture.transient, capture.transient}, 0.0, 0.0};
    core::VelocityHistogram velocity;
    velocity.axis.num_bins = 10;  // as many as two histograms
    velocity.values = core::Transient(6, 10);
    for (std::size_t i = 0; i < 60; ++i) velocity.values.values()[i] = static_cast<float>(i);
    capture.velocity = velocity;
    CaptureReadSettings settings;
    settings.flip_x = true;
    settings.flip_t = true;
    const Capture moved = adjusted(capture, settings);
    for (const core::Transient* transient : {&*moved.variance,
                                             &moved.by_order[0],
                                             &moved.sequence->frames[0],
                                             &moved.sequence->frames[1]}) {
        EXPECT_TRUE(std::ranges::equal(transient->values(), moved.transient.values()));
    }
    EXPECT_EQ(histogram_of(moved.velocity->values, 0), histogram_of(velocity.values, 4));
    capture.velocity->axis = {.num_bins = 2, .with_time = true};
    const Capture with_time = adjusted(capture, settings);
    EXPECT_EQ(histogram_of(with_time.velocity->values, 0),
              (std::vector<float>{44, 43, 42, 41, 40, 49, 48, 47, 46, 45}));
}

TEST(CaptureAdjustment, FlipOfTimeReversesHistogramsAndKeepsTheAxis) {
    const Capture capture = example_capture(ScanPattern::Confocal);
    CaptureReadSettings settings;
    settings.flip_t = true;
    const Capture reversed = adjusted(capture, settings);
    std::vector<float> expected = histogram_of(capture.transient, 2);
    std::ranges::reverse(expected);
    EXPECT_EQ(histogram_of(reversed.transient, 2), expected);
    EXPECT_EQ(reversed.time_axis.opl_start_m, capture.time_axis.opl_start_m);
}

TEST(CaptureAdjustment, OriginAndUnitAreReplaced) {
    Capture capture = example_capture(ScanPattern::Confocal);
    capture.unit = core::TransientUnit::Counts;
    capture.counts_per_radiance = 5.0;
    CaptureReadSettings settings;
    settings.opl_origin = core::OplOrigin::Device;
    settings.unit = core::TransientUnit::Radiance;
    const Capture changed = adjusted(capture, settings);
    EXPECT_EQ(changed.scan.opl_origin(), core::OplOrigin::Device);
    EXPECT_EQ(changed.unit, core::TransientUnit::Radiance);
    EXPECT_FALSE(changed.counts_per_radiance);
}

TEST(CaptureAdjustment, RefusesWhatTheCaptureCannotDo) {
    Capture list = example_capture(ScanPattern::Confocal);
    for (core::WallPoints* points : {&list.scan.wall().sensing, &list.scan.wall().illumination}) {
        *points = test_support::as_list(*points);
    }
    CaptureReadSettings flip;
    flip.flip_y = true;
    EXPECT_ERROR_WITH(adjusted(list, flip), "file: has a list of wall points; must have a grid");
    CaptureReadSettings size;
    size.wall_size_m = {1.0, 1.0};
    EXPECT_ERROR_WITH(adjusted(test_support::example_image(), size), "is the image of a camera");
}

}  // namespace
}  // namespace nlos
