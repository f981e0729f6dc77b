// SPDX-License-Identifier: MIT
#include "nlos/capture_check.h"

#include "tests/nlos/confocal_scene.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

using core::Vec3;

core::Capture lit_capture() {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({16, 16}, {0.05, 0.05}), {-0.4, 0.01, 300});
    nlos_test::add_scatterer(capture, Vec3(0.9, -0.8, 0.3), 4.0);
    return capture;
}

TEST(CaptureCheck, HasNothingToSayAboutAGoodCapture) {
    EXPECT_TRUE(timing_warnings(lit_capture()).empty());
    core::Capture counts = lit_capture();
    counts.unit = core::TransientUnit::Counts;
    for (float& value : counts.transient.values()) value = std::round(100.0F * value) + 3.0F;
    EXPECT_TRUE(timing_warnings(counts).empty());
}

TEST(CaptureCheck, WarnsOfLightBeforeTheShortestPath) {
    core::Capture capture = lit_capture();
    capture.time_axis.opl_start_m -= 2.5;
    const auto warnings = timing_warnings(capture);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("time zero"), std::string::npos) << warnings[0];
}

TEST(CaptureCheck, WarnsOfBinsThatAreStatedTooWide) {
    core::Capture capture = lit_capture();
    capture.time_axis.bin_width_m *= 2.0;
    const auto warnings = timing_warnings(capture);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("narrower"), std::string::npos) << warnings[0];
}

TEST(CaptureCheck, SaysNothingAboutDarkness) {
    core::Capture capture = lit_capture();
    std::fill(capture.transient.values().begin(), capture.transient.values().end(), 0.0F);
    EXPECT_TRUE(timing_warnings(capture).empty());
}

}  // namespace
}  // namespace nlos
