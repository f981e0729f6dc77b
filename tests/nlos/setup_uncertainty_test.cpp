// SPDX-License-Identifier: MIT
// What an uncertain set-up does to depths: against what reconstructions of moved captures show.
#include "nlos/setup_uncertainty.h"

#include "nlos/reconstruct.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nlos {
namespace {

using core::Vec3;

constexpr double kSetupPitch_m = 0.04;

/// Counts of a plate of some slope along x.
core::Capture plate_counts(double x_m = 0.0, double slope = 0.1) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({20, 20}, {kSetupPitch_m, kSetupPitch_m}), {0.6, 0.008, 192});
    for (int i = 0; i < 60; ++i) {
        for (int j = 0; j < 60; ++j) {
            const double along_m = 0.008 * (i - 29.5);
            const Vec3 at(x_m + along_m, 0.008 * (j - 29.5), 0.6 + slope * along_m);
            nlos_test::add_scatterer(capture, at, 4.0);
        }
    }
    capture.unit = core::TransientUnit::Counts;
    double largest = 0.0;
    for (const float value : capture.transient.values()) {
        largest = std::max(largest, double{value});
    }
    for (float& value : capture.transient.values()) {
        value = std::round(value * static_cast<float>(300.0 / largest));
    }
    return capture;
}

Reconstruction with_setup(const core::Capture& capture, const std::vector<std::string>& overrides) {
    ReconstructSettings settings;
    settings.method = Method::Lct;
    for (const std::string& text : overrides) core::apply_override(settings, text);
    return reconstruct(capture, settings, {});
}

/// How far the plate's middle, that of a line through its depths, moves when the capture is
/// described otherwise.
double moved_by(const core::Capture& right, const core::Capture& wrong, double x_m = 0.0) {
    const auto depth_of = [x_m](const core::Capture& capture) {
        const Reconstruction result = with_setup(capture, {"volume.z_range_m=[0.4,0.8]"});
        const core::DepthMap& depth = result.depth;
        double n = 0.0, x = 0.0, xx = 0.0, z = 0.0, xz = 0.0;  // from the middle
        for (std::size_t ix = 0; ix < depth.x_m.size(); ++ix) {
            for (std::size_t iy = 0; iy < depth.y_m.size(); ++iy) {
                const double reach =
                    std::max(std::abs(depth.x_m[ix] - x_m), std::abs(depth.y_m[iy]));
                const std::size_t i = depth.index(ix, iy);
                if (!(reach < 0.18) || !depth.is_foreground(i)) continue;
                const double beside_m = depth.x_m[ix] - x_m;
                n += 1.0;
                x += beside_m;
                xx += beside_m * beside_m;
                z += depth.depth_m[i];
                xz += beside_m * depth.depth_m[i];
            }
        }
        EXPECT_GT(n, 40.0);
        return (z * xx - x * xz) / (n * xx - x * x);
    };
    return std::abs(depth_of(wrong) - depth_of(right));
}

/// The median of what the set-up adds to depths.
double reported(const core::Capture& capture, const std::string& text) {
    const Reconstruction result = with_setup(capture, {"volume.z_range_m=[0.4,0.8]", text});
    EXPECT_TRUE(result.setup.has_value()) << text;
    return result.setup ? result.setup->depth_sigma_m : 0.0;
}

// A derivative at half a voxel against a step of several: to a fifth.
TEST(SetupUncertainty, MovesDepthsAsAMovedTimeZeroDoes) {
    constexpr double kSigma_ps = 40.0;
    const double moved = moved_by(plate_counts(), [&] {
        core::Capture wrong = plate_counts();
        wrong.time_axis.opl_start_m += kSigma_ps * 1e-12 * core::kSpeedOfLight;
        return wrong;
    }());
    EXPECT_GT(moved, 0.003);  // 12 mm of path
    EXPECT_NEAR(reported(plate_counts(), "setup.time_zero_sigma_ps=40"), moved, 0.2 * moved);
}

TEST(SetupUncertainty, MovesDepthsAsAWallOfAnotherSizeDoes) {
    constexpr double kSigma = 0.02;
    // Beside the middle, where all of it moves to the same side.
    const core::Capture right = plate_counts(0.15, 0.4);
    core::Capture wrong = right;
    core::WallScan& scan = wrong.scan.wall();
    for (core::WallPoints* points : {&scan.sensing, &scan.illumination}) {
        for (Vec3& point : points->positions) point *= 1.0 + kSigma;
    }
    const double moved = moved_by(right, wrong, 0.15);
    EXPECT_NEAR(reported(right, "setup.wall_scale_sigma=0.02"), moved, 0.25 * moved);
}

TEST(SetupUncertainty, IsAddedToTheNoiseInSquares) {
    const core::Capture capture = plate_counts();
    const Reconstruction exact = with_setup(capture, {"setup=none"});
    EXPECT_FALSE(exact.setup);
    const Reconstruction uncertain =
        with_setup(capture, {"setup.time_zero_sigma_ps=30", "setup.wall_scale_sigma=0.01"});
    ASSERT_TRUE(uncertain.setup);
    EXPECT_EQ(uncertain.setup->effects.size(), 2U);
    ASSERT_EQ(uncertain.depth_sigma_m.size(), exact.depth_sigma_m.size());
    for (std::size_t i = 0; i < exact.depth_sigma_m.size(); ++i) {
        ASSERT_EQ(std::isnan(exact.depth_sigma_m[i]), std::isnan(uncertain.depth_sigma_m[i]));
        if (std::isnan(exact.depth_sigma_m[i])) continue;
        const double own = uncertain.setup->sigma_m[i];
        EXPECT_DOUBLE_EQ(uncertain.depth_sigma_m[i],
                         std::hypot(exact.depth_sigma_m[i], std::isnan(own) ? 0.0 : own));
    }
    EXPECT_NE(describe(*uncertain.setup).find("30 ps of time zero"), std::string::npos);
}

// Surfaces of methods that iterate move with a direct method's.
TEST(SetupUncertainty, OfTheSolverIsThatOfADirectMethod) {
    const core::Capture capture = plate_counts();
    const double direct = reported(capture, "setup.time_zero_sigma_ps=30");
    const Reconstruction solved = with_setup(
        capture, {"method=solver", "volume.z_range_m=[0.4,0.8]", "setup.time_zero_sigma_ps=30"});
    ASSERT_TRUE(solved.setup);
    EXPECT_NEAR(solved.setup->depth_sigma_m, direct, 0.2 * direct);
}

TEST(SetupUncertainty, IsAssumedOfWhatWasMeasuredOnly) {
    core::Capture capture = plate_counts();
    EXPECT_FALSE(with_setup(capture, {}).setup);
    capture.scene_info["original_format"] = "a lab's";
    const Reconstruction measured = with_setup(capture, {});
    ASSERT_TRUE(measured.setup);
    EXPECT_EQ(*measured.settings.setup.time_zero_sigma_ps, 10.0);
    EXPECT_EQ(*measured.settings.setup.wall_scale_sigma, 0.003);
    EXPECT_FALSE(with_setup(capture, {"setup=none"}).setup);
    EXPECT_NE(test_support::error_message([&] {
                  with_setup(capture, {"setup=fit"});
              }).find("nlos calibrate"),
              std::string::npos);
}

}  // namespace
}  // namespace nlos
