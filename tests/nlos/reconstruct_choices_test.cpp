// SPDX-License-Identifier: MIT
// What reconstruct() fills in: bins to merge, how light falls off, which surface has the depth.
#include "nlos/reconstruct.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Vec3;

ReconstructSettings chosen_with(const std::vector<std::string>& overrides) {
    ReconstructSettings settings;
    for (const std::string& text : overrides) core::apply_override(settings, text);
    return settings;
}

TEST(ReconstructChoices, MergesBinsUpToAQuarterOfThePitch) {
    core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({8, 8}, {0.05, 0.04}), {0.0, 0.0048, 256});
    EXPECT_EQ(reconstruct(capture, {}, {}).settings.merge_bins, 4);  // 9.6 mm of range, limit 10 mm
}

// 500 ps deviate by 32 mm of range, of which 0.4 are the limit: 12.7 mm.
TEST(ReconstructChoices, MergesBinsThatTheResponseSmearsWhereTheSolverExplainsIt) {
    const core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({8, 8}, {0.02, 0.02}), {0.0, 0.0048, 256});
    const auto merged = [&](const std::string& method, const std::string& fwhm_ps) {
        return reconstruct(capture, chosen_with({method, "response.jitter_fwhm_ps=" + fwhm_ps}), {})
            .settings.merge_bins;
    };
    EXPECT_EQ(merged("method=solver", "500"), 4);
    EXPECT_EQ(merged("method=solver", "60"), 2);
    EXPECT_EQ(merged("method=lct", "500"), 2);
}

TEST(ReconstructChoices, AutoTellsRetroreflectiveFromDiffuseCounts) {
    for (const double falloff : {2.0, 4.0}) {
        core::Capture capture = nlos_test::confocal_capture(
            nlos_test::wall_grid({16, 16}, {0.1, 0.1}), {0.0, 0.016, 128});
        for (int i = -3; i <= 3; ++i) {
            for (int j = -3; j <= 3; ++j) {
                nlos_test::add_scatterer(capture, Vec3(0.05 * i, 0.05 * j, 0.4), falloff);
            }
        }
        const auto values = capture.transient.values();
        const float largest = *std::ranges::max_element(values);
        for (float& value : values) value = std::round(1000.0F * value / largest);
        capture.unit = core::TransientUnit::Counts;
        EXPECT_EQ(reconstruct(capture, {}, {}).settings.falloff,
                  falloff == 2.0 ? Falloff::Retro : Falloff::Diffuse);
    }
}

// A plate, and before it a strip of three columns, which hold both and the plate brighter.
TEST(ReconstructChoices, TakesTheSurfaceInFrontOnConfocalGrids) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({24, 24}, {0.04, 0.04}), {0.0, 0.016, 128});
    for (int i = -30; i <= 30; ++i) {
        for (int j = -30; j <= 30; ++j) {
            nlos_test::add_scatterer(capture, Vec3(0.01 * i, 0.01 * j, 0.6), 4.0);
            if (std::abs(i) > 5) continue;
            nlos_test::add_scatterer(capture, Vec3(0.01 * i, 0.01 * j, 0.45), 4.0);
        }
    }
    for (const std::string method : {"fk", "solver"}) {
        const auto result = reconstruct(capture, chosen_with({"method=" + method}), {});
        const core::DepthMap& depth = result.depth;
        EXPECT_NEAR(depth.depth_m[depth.index(12, 12)], 0.45, 0.01) << method;
        EXPECT_NEAR(depth.depth_m[depth.index(17, 12)], 0.6, 0.01) << method;
    }
}

TEST(ReconstructChoices, TakesTheSpotThatTheCaptureGives) {
    core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({8, 8}, {0.05, 0.05}), {0.0, 0.0048, 256});
    const auto spot_m = [&](const std::vector<std::string>& overrides) {
        return reconstruct(capture, chosen_with(overrides), {}).settings.solver.spot_m;
    };
    EXPECT_EQ(spot_m({"method=solver"}), 0.0);
    capture.scene_info["detector"]["spot_m"] = 0.08;
    EXPECT_EQ(spot_m({"method=solver"}), 0.08);
    EXPECT_EQ(spot_m({"method=solver", "solver.spot_m=0.05"}), 0.05);
}

// Depth smeared by 1.3 distances of wall points. The solver tells how light falls off from radiance
// too, and finds the plate to a third of the 0.13 m by which the response deviates.
TEST(ReconstructChoices, TellsSurfacesThatFaceTheWallWhereTheResponseSmearsDepth) {
    for (const Falloff falloff : {Falloff::Retro, Falloff::Diffuse, Falloff::Facing}) {
        core::Capture capture = nlos_test::confocal_capture(
            nlos_test::wall_grid({16, 16}, {0.1, 0.1}), {0.0, 0.016, 256});
        for (int i = -3; i <= 3; ++i) {
            for (int j = -3; j <= 3; ++j) {
                nlos_test::add_scatterer(
                    capture, Vec3(0.05 * i, 0.05 * j, 0.8), falloff_power(falloff));
            }
        }
        capture.transient = core::apply_filter(
            core::sample_response(core::GaussianResponse{0.26}, 0.016), capture.transient);
        const std::string response =
            fmt::format("response.jitter_fwhm_ps={}", 0.26 / core::sigma_m_from_fwhm_ps(1.0));
        const Reconstruction result =
            reconstruct(capture, chosen_with({"method=solver", response}), {});
        EXPECT_EQ(result.settings.falloff, falloff);
        EXPECT_NEAR(nlos_test::brightest_point(result).z(), 0.8, 0.04);
    }
}

}  // namespace
}  // namespace nlos
