// SPDX-License-Identifier: MIT
#include "nlos/preparation/prepared_capture.h"

#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace nlos {
namespace {

using core::ScanPattern;
using core::Vec3;

core::Capture numbered_capture(ScanPattern pattern) {
    core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({6, 5}, {0.1, 0.1}), {0.2, 0.01, 20});
    capture.scan.wall().pattern = pattern;
    if (pattern == ScanPattern::Exhaustive) {
        capture.scan.wall().illumination = nlos_test::wall_grid({3, 3}, {0.1, 0.1});
    }
    capture.transient = core::Transient(capture.scan.num_pairs(), 20);
    float next = 0.0F;
    for (float& value : capture.transient.values()) value = next += 1.0F;
    return capture;
}

TEST(PreparedCapture, WithoutACropIsTheCapture) {
    const core::Capture capture = numbered_capture(ScanPattern::Confocal);
    const PreparedCapture prepared = crop_capture(capture, {});
    EXPECT_EQ(&prepared.transient(), &capture.transient);
    EXPECT_EQ(prepared.scan.sensing.size(), 30U);
}

TEST(PreparedCapture, CropKeepsPointsBinsAndGridTogether) {
    for (const ScanPattern pattern : {ScanPattern::Confocal, ScanPattern::Exhaustive}) {
        const core::Capture capture = numbered_capture(pattern);
        CropSettings crop;
        crop.x_range_m = {-0.16, 0.06};
        crop.y_range_m = {-0.01, 0.11};
        crop.opl_range_m = {0.25, 0.31};
        const PreparedCapture cut = crop_capture(capture, crop);
        EXPECT_EQ(cut.scan.sensing.grid, (std::array<std::size_t, 2>{3, 2}));
        EXPECT_EQ(cut.time_axis.num_bins, 6);
        EXPECT_NEAR(cut.time_axis.opl_start_m, 0.25, 1e-12);
        ASSERT_EQ(cut.transient().num_pairs(), cut.scan.num_pairs());
        for (std::size_t pair = 0; pair < cut.scan.num_pairs(); ++pair) {
            // The histogram of the same two points in the capture.
            std::size_t original = 0;
            const auto same = [](const Vec3& a, const Vec3& b) { return (a - b).norm() < 1e-9; };
            const Vec3 l = cut.scan.illumination_point(pair);
            const Vec3 s = cut.scan.sensing_point(pair);
            const core::WallScan& scan = capture.scan.wall();
            while (!same(scan.illumination.positions[scan.illumination_index(original)], l) ||
                   !same(scan.sensing.positions[scan.sensing_index(original)], s)) {
                ++original;
            }
            EXPECT_EQ(cut.transient().histogram(pair)[0], capture.transient.histogram(original)[5]);
        }
    }
}

TEST(PreparedCapture, ACropThatLeavesNothingIsAnError) {
    const core::Capture capture = numbered_capture(ScanPattern::Confocal);
    CropSettings crop;
    crop.x_range_m = {3.0, 4.0};
    EXPECT_ERROR_WITH(crop_capture(capture, crop), "0 sensing points");
    crop.x_range_m.reset();
    crop.opl_range_m = {3.0, 4.0};
    EXPECT_ERROR_WITH(crop_capture(capture, crop), "0 bins");
}

TEST(PreparedCapture, ManyLasersAndOneDetectorAreOneLaserAndManyDetectors) {
    core::Capture capture = numbered_capture(ScanPattern::Confocal);
    capture.scan.wall().pattern = ScanPattern::Exhaustive;
    capture.scan.wall().sensing = nlos_test::wall_grid({1, 1}, {1.0, 1.0});
    capture.scan.wall().laser_position = Vec3(1.0, 0.0, -1.0);
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    const PreparedCapture swapped = crop_capture(capture, {});
    EXPECT_EQ(swapped.scan.pattern, ScanPattern::Single);
    EXPECT_EQ(swapped.scan.sensing.size(), 30U);
    for (std::size_t pair = 0; pair < 30; ++pair) {
        EXPECT_DOUBLE_EQ(swapped.scan.device_segments_m(pair),
                         capture.scan.wall().device_segments_m(pair));
    }
}

TEST(MidpointConversion, IsExactForPointsEquallyFarFromBoth) {
    core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({9, 1}, {0.1, 0.1}), {0.0, 0.01, 300});
    capture.scan.wall().sensing = nlos_test::wall_grid({9, 2}, {0.1, 0.1});
    capture.scan.wall().illumination = nlos_test::wall_grid({1, 1}, {1.0, 1.0});
    capture.scan.wall().pattern = ScanPattern::Single;
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    capture.scan.wall().laser_position = Vec3(0.0, 0.3, -0.4);
    capture.scan.wall().detector_position = Vec3(0.2, 0.0, -0.3);
    capture.transient = core::Transient(18, 300);
    // Straight before the midpoint of each pair, half a metre away.
    for (std::size_t pair = 0; pair < 18; ++pair) {
        const Vec3 p = 0.5 * capture.scan.wall().sensing.positions[pair] + Vec3(0.0, 0.0, 0.5);
        const double opl = p.norm() + (p - capture.scan.wall().sensing.positions[pair]).norm() +
                           capture.scan.wall().device_segments_m(pair);
        capture.transient.histogram(pair)[*capture.time_axis.bin_of(opl)] = 1.0F;
    }
    PreparedCapture confocal = crop_capture(capture, {});
    ASSERT_TRUE(convert_to_confocal(confocal));
    ASSERT_EQ(confocal.scan.sensing.grid, (std::array<std::size_t, 2>{9, 2}));
    for (std::size_t point = 0; point < 18; ++point) {
        EXPECT_LT((confocal.scan.sensing.positions[point] -
                   0.5 * capture.scan.wall().sensing.positions[point])
                      .norm(),
                  1e-9);
        const auto histogram = confocal.transient().histogram(point);
        double sum = 0.0;
        double mean = 0.0;
        for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
            sum += histogram[bin];
            mean += histogram[bin] * confocal.time_axis.bin_center_m(static_cast<double>(bin));
        }
        EXPECT_NEAR(sum, 1.0, 1e-5);
        EXPECT_NEAR(mean / sum, 1.0, 0.012);  // path length to and from a point 0.5 m away
    }
}

TEST(MidpointConversion, MidpointsThatLeaveGapsAreRefused) {
    core::Capture capture = numbered_capture(ScanPattern::Exhaustive);
    capture.scan.wall().sensing = nlos_test::wall_grid({4, 4}, {0.1, 0.1});
    // Midpoints in rows 0 to 3 and 8 to 11 of 12: 144 pairs for 48 points, none in the middle.
    for (core::Vec3& position : capture.scan.wall().illumination.positions) position.setZero();
    capture.scan.wall().illumination.positions.back().x() = 0.8;
    capture.transient = core::Transient(capture.scan.num_pairs(), 20);
    PreparedCapture prepared = crop_capture(capture, {});
    EXPECT_FALSE(convert_to_confocal(prepared));
}

TEST(MidpointConversion, GridsOfMorePointsThanPairsAreRefusedBeforeTheyAreMade) {
    core::Capture capture = numbered_capture(ScanPattern::Exhaustive);
    for (const double distance_m : {1.0, 1e6, 1e9}) {  // 1e9: 4e20 points
        capture.scan.wall().illumination = nlos_test::wall_grid({2, 2}, {distance_m, distance_m});
        capture.transient = core::Transient(capture.scan.num_pairs(), 20);
        PreparedCapture prepared = crop_capture(capture, {});
        EXPECT_FALSE(convert_to_confocal(prepared));
    }
}

TEST(MidpointConversion, AnAxisThatStartsFarBehindTheWallIsRefusedBeforeItIsMade) {
    core::Capture capture = numbered_capture(ScanPattern::Single);
    capture.scan.wall().illumination = nlos_test::wall_grid({1, 1}, {0.1, 0.1});
    for (const double start_m : {1e9, 1e15}) {  // 1e11 and 1e17 bins from the wall on
        capture.time_axis.opl_start_m = start_m;
        PreparedCapture prepared = crop_capture(capture, {});
        EXPECT_THROW(convert_to_confocal(prepared), core::Failure);
    }
}

}  // namespace
}  // namespace nlos
