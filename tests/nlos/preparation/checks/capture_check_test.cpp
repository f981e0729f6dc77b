// SPDX-License-Identifier: MIT
#include "nlos/preparation/checks/capture_check.h"

#include "nlos/detector/detector.h"
#include "nlos/preparation/first_light.h"
#include "tests/nlos/methods/confocal_scene.h"

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
    EXPECT_TRUE(capture_warnings(lit_capture()).empty());
    core::Capture counts = lit_capture();
    counts.unit = core::TransientUnit::Counts;
    for (float& value : counts.transient.values()) value = std::round(100.0F * value) + 3.0F;
    EXPECT_TRUE(capture_warnings(counts).empty());
}

TEST(CaptureCheck, WarnsOfLightBeforeTheShortestPath) {
    core::Capture capture = lit_capture();
    capture.time_axis.opl_start_m -= 2.5;
    const auto warnings = capture_warnings(capture);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("time zero"), std::string::npos) << warnings[0];
}

TEST(CaptureCheck, WarnsOfBinsThatAreGivenTooWide) {
    core::Capture capture = lit_capture();
    capture.time_axis.bin_width_m *= 2.0;
    const auto warnings = capture_warnings(capture);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("lengths look 2 times too long"), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find("--set capture.bin_width_m=0.01"), std::string::npos) << warnings[0];
}

/// A bent bar of points before the middle of the wall, with counts if asked for.
core::Capture bar_capture(core::TransientUnit unit) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({32, 32}, {0.03, 0.03}), {0.0, 0.008, 500});
    for (int i = 0; i <= 20; ++i) {
        const double t = 0.1 * i - 1.0;
        nlos_test::add_scatterer(capture, Vec3(0.2 * t, 0.05 + 0.1 * t, 0.6 + 0.1 * t * t), 4.0);
    }
    if (unit == core::TransientUnit::Counts) {
        DetectorSettings settings;
        settings.photons = 2e6;
        settings.ambient = 0.05;
        capture = detect(capture, settings);
    }
    return capture;
}

TEST(CaptureCheck, WarnsOfBinsGivenTooWideOrTooNarrow) {
    for (const auto unit : {core::TransientUnit::Radiance, core::TransientUnit::Counts}) {
        const core::Capture right = bar_capture(unit);
        EXPECT_TRUE(capture_warnings(right).empty());
        for (const double factor : {0.75, 1.25, 1.6}) {
            core::Capture wrong = right;
            wrong.time_axis.bin_width_m *= factor;
            const auto warnings = capture_warnings(wrong);
            ASSERT_EQ(warnings.size(), 1U) << factor;
            EXPECT_NE(warnings[0].find(factor > 1.0 ? "look narrower" : "look wider"),
                      std::string::npos)
                << warnings[0];
        }
    }
}

TEST(CaptureCheck, NamesUnitsThatValuesContradict) {
    core::Capture counts = bar_capture(core::TransientUnit::Counts);
    counts.unit = core::TransientUnit::Radiance;
    ASSERT_EQ(capture_warnings(counts).size(), 1U);
    EXPECT_NE(capture_warnings(counts)[0].find("--set capture.unit=counts"), std::string::npos);
    core::Capture radiance = bar_capture(core::TransientUnit::Radiance);
    radiance.unit = core::TransientUnit::Counts;
    ASSERT_EQ(capture_warnings(radiance).size(), 1U);
    EXPECT_NE(capture_warnings(radiance)[0].find("--set capture.unit=radiance"), std::string::npos);
}

TEST(CaptureCheck, TellsTheFactorOfWrongBinsAndOfAWrongWall) {
    const core::Capture right = bar_capture(core::TransientUnit::Radiance);
    const std::vector<double> dark(right.scan.num_pairs(), 0.0);
    for (const double factor : {0.6, 1.0, 1.5}) {
        core::Capture bins = right;
        bins.time_axis.bin_width_m *= factor;
        EXPECT_NEAR(std::sqrt(bend_of_first_light(bins, first_light_m(bins, dark))->k),
                    factor,
                    0.05 * factor);
        core::Capture wall = right;
        for (core::WallPoints* points :
             {&wall.scan.wall().sensing, &wall.scan.wall().illumination}) {
            for (Vec3& position : points->positions) position /= factor;
        }
        EXPECT_NEAR(std::sqrt(bend_of_first_light(wall, first_light_m(wall, dark))->k),
                    factor,
                    0.05 * factor);
    }
}

// A chair: over the wall, first light's fraction of a maximum is passed by legs, seat or back.
TEST(CaptureCheck, SurfacesThatTakeTurnsSayNothingWrongOfBins) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({48, 48}, {1.5 / 48, 1.5 / 48}), {1.504, 0.016, 165});
    const auto add_plate = [&](double x0, double x1, double y0, double y1, double z) {
        for (double x = x0 + 0.005; x < x1; x += 0.01) {
            for (double y = y0 + 0.005; y < y1; y += 0.01) {
                nlos_test::add_scatterer(capture, Vec3(x, y, z), 4.0);
            }
        }
    };
    add_plate(-0.22, 0.22, -0.14, 0.30, 1.18);   // back
    add_plate(-0.22, 0.22, -0.18, -0.14, 0.78);  // seat
    for (const double x : {-0.22, 0.18}) {
        add_plate(x, x + 0.04, -0.60, -0.18, 0.78);  // legs
        add_plate(x, x + 0.04, -0.60, -0.18, 1.18);
    }
    const std::vector<double> dark(capture.scan.num_pairs(), 0.0);
    const auto wrong = [&](double fraction) {
        return std::abs(
            std::log(bend_of_first_light(capture, first_light_m(capture, dark, fraction))->k));
    };
    EXPECT_LT(wrong(0.1), 0.5 * wrong(kFirstLightFraction));
    EXPECT_EQ(capture_warnings(capture), std::vector<std::string>{});
}

TEST(CaptureCheck, APlaneSaysNothingWrongOfBins) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({24, 24}, {0.04, 0.04}), {0.0, 0.016, 200});
    for (int ix = -40; ix <= 40; ++ix) {
        for (int iy = -40; iy <= 40; ++iy) {
            nlos_test::add_scatterer(capture, Vec3(0.02 * ix, 0.02 * iy, 0.5), 4.0);
        }
    }
    EXPECT_EQ(capture_warnings(capture), std::vector<std::string>{});
    for (const double factor : {0.5, 2.0}) {
        core::Capture scaled = capture;
        scaled.time_axis.bin_width_m *= factor;
        for (const std::string& warning : capture_warnings(scaled)) {  // its edges may tell
            EXPECT_NE(warning.find("capture.bin_width_m=0.016"), std::string::npos) << warning;
        }
    }
}

TEST(CaptureCheck, OfDarknessSaysThatAlone) {
    core::Capture capture = lit_capture();
    std::fill(capture.transient.values().begin(), capture.transient.values().end(), 0.0F);
    EXPECT_EQ(capture_warnings(capture),
              std::vector<std::string>{"the capture holds no light: all its values are 0"});
}

TEST(CaptureCheck, GatesThatCutLightAreNamed) {
    core::Capture capture = lit_capture();
    capture.scene_info["light"] = {{"share_in_axis", 0.4}};
    ASSERT_EQ(capture_warnings(capture).size(), 1U);
    EXPECT_NE(capture_warnings(capture)[0].find("hold 40 % of the scene's light"),
              std::string::npos);
    capture.scene_info["light"] = {{"share_in_axis", 0.999}};
    EXPECT_TRUE(capture_warnings(capture).empty());
    capture.scene_info["light"] = "bright";
    EXPECT_TRUE(capture_warnings(capture).empty());
}

}  // namespace
}  // namespace nlos
