// SPDX-License-Identifier: MIT
#include "nlos/preparation/capture_faults.h"

#include "nlos/preparation/checks/capture_check.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace nlos {
namespace {

using core::Vec3;
using PairBin = CaptureFaults::PairBin;

constexpr std::size_t kSide = 12;
constexpr std::size_t kPoint = 5 * kSide + 7;

/// A tilted plate of points and one that is much nearer.
core::Capture plate_capture(core::ScanPattern pattern = core::ScanPattern::Confocal) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({kSide, kSide}, {0.05, 0.05}), {0.0, 0.016, 128});
    if (pattern == core::ScanPattern::Single) {
        capture.scan.wall().pattern = pattern;
        capture.scan.wall().illumination = nlos_test::wall_grid({1, 1}, {1.0, 1.0});
    }
    for (int ix = -5; ix <= 5; ++ix) {
        for (int iy = -5; iy <= 5; ++iy) {
            const Vec3 place(0.03 * ix, 0.03 * iy, 0.5 + 0.02 * ix);
            nlos_test::add_scatterer(capture, place, 4.0);
        }
    }
    nlos_test::add_scatterer(capture, Vec3(0.11, -0.12, 0.15), 4.0);
    return capture;
}

/// The plate as counts, with so many in its brightest bin and a background.
core::Capture plate_counts(double brightest, double background) {
    core::Capture capture = plate_capture();
    capture.unit = core::TransientUnit::Counts;
    const auto values = capture.transient.values();
    const double scale = brightest / static_cast<double>(*std::ranges::max_element(values));
    std::mt19937_64 generator(test_support::seed_of("PlateCounts"));
    for (float& value : values) {
        std::poisson_distribution<int> counts(scale * static_cast<double>(value) + background);
        value = static_cast<float>(counts(generator));
    }
    return capture;
}

float largest(const core::Capture& capture) {
    return *std::ranges::max_element(capture.transient.values());
}

TEST(CaptureFaults, GoodCapturesHaveNone) {
    for (const core::Capture& capture : {plate_capture(),
                                         plate_capture(core::ScanPattern::Single),
                                         plate_counts(3.0, 0.0),
                                         plate_counts(500.0, 0.0),
                                         plate_counts(20.0, 4.0)}) {
        EXPECT_TRUE(find_faults(capture).empty()) << *describe(find_faults(capture));
    }
}

// A retroreflector, a hundred times as bright as the plate, is seen by every wall point.
TEST(CaptureFaults, AStrongReturnIsNone) {
    core::Capture capture = plate_capture();
    for (int i = 0; i < 100; ++i) nlos_test::add_scatterer(capture, Vec3(0.02, 0.01, 0.3), 4.0);
    EXPECT_TRUE(find_faults(capture).empty());
}

TEST(CaptureFaults, AHotBinIsFoundWhereverItIs) {
    for (core::Capture& capture :
         std::array{plate_capture(), plate_counts(50.0, 0.0), plate_counts(20.0, 4.0)}) {
        const core::Capture good = capture;
        for (const int bin : {1, 3, 10, 62, 90, 127}) {
            for (const std::size_t point : {std::size_t{0}, kPoint, kSide * kSide - 1}) {
                capture = good;
                capture.transient.histogram(point)[static_cast<std::size_t>(bin)] =
                    std::ceil(100.0F * largest(good));
                const CaptureFaults faults = find_faults(capture);
                ASSERT_EQ(faults.hot_bins, (std::vector<PairBin>{{point, bin}}));
                EXPECT_TRUE(faults.hot_points.empty());
            }
        }
    }
}

TEST(CaptureFaults, AHotBinHoldsWhatItsNeighboursDoOnceItIsLeftOut) {
    const core::Capture good = plate_counts(50.0, 4.0);
    core::Capture capture = good;
    capture.transient.histogram(kPoint)[62] = 65535.0F;
    const core::Capture mended = leave_out(find_faults(capture), capture);
    const auto histogram = mended.transient.histogram(kPoint);
    EXPECT_EQ(histogram[62], std::round(0.5F * (histogram[61] + histogram[63])));
    EXPECT_FALSE(mended.observed);
    const auto differ = [&](std::size_t i) {
        return mended.transient.values()[i] != good.transient.values()[i];
    };
    std::size_t changed = 0;
    for (std::size_t i = 0; i < good.transient.values().size(); ++i) changed += differ(i) ? 1 : 0;
    EXPECT_LE(changed, 1U);
}

TEST(CaptureFaults, HotAndDeadPointsCountAsNotObserved) {
    for (const core::Capture& good : {plate_capture(), plate_counts(200.0, 1.0)}) {
        core::Capture capture = good;
        std::ranges::fill(capture.transient.histogram(kPoint), 20.0F * largest(good));
        std::ranges::fill(capture.transient.histogram(3), 0.0F);
        const CaptureFaults faults = find_faults(capture);
        EXPECT_EQ(faults.hot_points, std::vector<std::size_t>{kPoint});
        EXPECT_EQ(faults.dead_points, std::vector<std::size_t>{3});
        const core::Capture mended = leave_out(faults, capture);
        EXPECT_EQ(mended.observed_range(kPoint).size(), 0);
        EXPECT_EQ(mended.observed_range(3).size(), 0);
        EXPECT_EQ(mended.observed_range(4).size(), 128);
        EXPECT_EQ(capture_warnings(capture).size(), 1U);
    }
}

/// Counts of the plate that a detector clips.
core::Capture clipped_plate(float ceiling, double brightest) {
    core::Capture capture = plate_counts(brightest, 1.0);
    for (float& value : capture.transient.values()) value = std::min(value, ceiling);
    return capture;
}

TEST(CaptureFaults, SaturatedBinsAreThoseThatNoNoiseLeavesOnOneNumber) {
    const core::Capture clipped = clipped_plate(255.0F, 2000.0);
    const CaptureFaults faults = find_faults(clipped);
    const auto at_ceiling = std::ranges::count(clipped.transient.values(), 255.0F);
    ASSERT_GT(at_ceiling, 20);
    EXPECT_EQ(faults.saturated_bins.size(), static_cast<std::size_t>(at_ceiling));
    for (const auto& [pair, bin] : faults.saturated_bins) {
        EXPECT_EQ(clipped.transient.histogram(pair)[static_cast<std::size_t>(bin)], 255.0F);
    }
    EXPECT_TRUE(faults.hot_bins.empty());
    EXPECT_NE(describe(faults)->find("saturated bin"), std::string::npos);
    // A ceiling that is no full byte, but cuts pulses: by runs, in counts and in means.
    core::Capture means = clipped_plate(40.0F, 2000.0);
    EXPECT_FALSE(find_faults(means).saturated_bins.empty());
    means.unit = core::TransientUnit::Radiance;
    for (float& value : means.transient.values()) value /= 700.0F;
    EXPECT_FALSE(find_faults(means).saturated_bins.empty());
    for (const double brightest : {2.0, 14.0, 255.0, 2000.0}) {
        EXPECT_TRUE(find_faults(plate_counts(brightest, 1.0)).empty()) << brightest;
    }
}

// A corner of the wall that a detector sees too brightly is more than a twentieth of the points.
TEST(CaptureFaults, NeighbouringPointsMayBeSaturated) {
    core::Capture capture = plate_counts(200.0, 1.0);
    std::vector<std::size_t> corner;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) corner.push_back(i * kSide + j);
    }
    for (const std::size_t point : corner) {
        std::ranges::fill(capture.transient.histogram(point), 4095.0F);
    }
    const CaptureFaults faults = find_faults(capture);
    EXPECT_EQ(faults.saturated_points, corner);
    EXPECT_TRUE(faults.hot_points.empty());
    EXPECT_EQ(leave_out(faults, capture).observed_range(0).size(), 0);
}

TEST(CaptureFaults, PointsThatMayBeDarkByChanceAreNotDead) {
    core::Capture capture = plate_counts(1.0, 0.0);
    for (float& value : capture.transient.values()) value = std::min(value, 1.0F);
    std::ranges::fill(capture.transient.histogram(kPoint), 0.0F);
    for (const std::size_t near : {kPoint - 1, kPoint + 1}) {
        std::ranges::fill(capture.transient.histogram(near), 0.0F);
        capture.transient.histogram(near)[70] = 3.0F;
    }
    EXPECT_TRUE(find_faults(capture).dead_points.empty());
}

TEST(CaptureFaults, AShadowIsNoRowOfDeadPoints) {
    core::Capture capture = plate_capture();
    for (std::size_t i = 0; i < kSide * kSide / 2; ++i) {
        std::ranges::fill(capture.transient.histogram(i), 0.0F);
    }
    EXPECT_TRUE(find_faults(capture).empty());
}

TEST(CaptureFaults, FewNegativeCountsAreFaultsAndManyABackgroundThatWasTakenOff) {
    core::Capture capture = plate_counts(50.0, 1.0);
    capture.transient.histogram(kPoint)[20] = -1.0F;
    EXPECT_EQ(find_faults(capture).negative_bins, (std::vector<PairBin>{{kPoint, 20}}));
    ASSERT_EQ(capture_warnings(capture).size(), 1U);
    EXPECT_NE(capture_warnings(capture)[0].find("1 negative bin (bin 20 of point 67)"),
              std::string::npos);
    for (float& value : capture.transient.values()) value -= 1.0F;
    EXPECT_TRUE(find_faults(capture).empty());
    ASSERT_EQ(capture_warnings(capture).size(), 1U);
    EXPECT_NE(capture_warnings(capture)[0].find("counts are negative"), std::string::npos);
}

}  // namespace
}  // namespace nlos
