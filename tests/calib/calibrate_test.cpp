// SPDX-License-Identifier: MIT
// Calibration of simulated set-ups: a tilted wall, what a result serves for, refusals.
#include "calib/calibrate.h"

#include "calib/fit.h"
#include "renderer/core/system/output_file.h"
#include "tests/calib/setup/simulated_setup.h"
#include "tests/support/error_message.h"
#include "tests/support/fit_examples.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using core::Vec3;
using setup_test::command_grid;
using setup_test::Device;
using setup_test::direct_returns;
using setup_test::kBin_m;
using setup_test::kSigma_m;
using setup_test::kZero_m;
using setup_test::ranges_of;
using setup_test::setup_of;
using setup_test::spot_of;

TEST(Calibrate, TiltedWallMeetsTheTargets) {
    Device device;
    device.tilt_x = 0.5;
    const auto commands = command_grid(16, 0.46);
    const auto capture = direct_returns(ranges_of(device, commands), 1000.0, 0.0, "TiltedWall");
    const calib::Calibration result = calib::calibrate(setup_of(commands), capture);
    EXPECT_NEAR(result.setup.values[0], 1.0, 0.0012);
    EXPECT_NEAR(result.setup.values[1], 0.5, 0.0006);
    EXPECT_NEAR(result.setup.values[2], 0.0, 0.0006);
    EXPECT_NEAR(result.setup.values[6], kZero_m, 0.0024);
    for (const std::size_t i : {0U, 1U, 2U, 6U}) {
        const double truth = i == 0 ? 1.0 : i == 1 ? 0.5 : i == 6 ? kZero_m : 0.0;
        EXPECT_NEAR(result.setup.values[i], truth, 4.5 * result.setup.sigma[i]);
    }
    for (std::size_t i = 0; i < commands.size(); ++i) {
        EXPECT_LT((result.setup.points_m[i] - spot_of(device, commands[i])).norm(), 0.003);
    }
}

TEST(Calibrate, FrontalWallWithOpenGainAndTimeZeroIsRefusedWithTheReason) {
    Device device;
    device.distance_m = 2.0;
    device.gain = 0.1;
    const auto commands = command_grid(12, 2.4);
    const auto capture = direct_returns(ranges_of(device, commands), 1000.0, 0.0, "Frontal");
    calib::SetupSettings settings = setup_of(commands);
    settings.command_unit = calib::CommandUnit::Volt;
    std::string message;
    try {
        calib::calibrate(settings, capture);
    } catch (const core::Failure& failure) {
        message = failure.what();
    }
    EXPECT_NE(message.find("singular"), std::string::npos) << message;
    EXPECT_NE(message.find("known.galvo_gain"), std::string::npos) << message;

    settings.known.galvo_gain = calib::KnownValue{0.1, 1e-4};
    settings.known.time_zero_m = calib::KnownValue{kZero_m, 1e-3};
    const calib::Calibration result = calib::calibrate(settings, capture);
    EXPECT_NEAR(result.setup.values[0], 2.0, 4.0 * result.setup.sigma[0]);
    EXPECT_LT(result.setup.sigma[0], 0.01);
}

calib::AppliedCalibration read_back(const calib::Calibration& calibration) {
    const test_support::TemporaryFolder folder;
    core::write_text_file(folder.file("c.json"), calib::calibration_json(calibration).dump());
    return calib::read_calibration(folder.file("c.json"));
}

TEST(Calibrate, ResultServesRenderReconstructAndFit) {
    Device device;
    device.tilt_x = 0.5;
    const auto commands = command_grid(6, 0.4);
    const auto capture = direct_returns(ranges_of(device, commands), 5000.0, 0.0, "Serves");
    const calib::Calibration result = calib::calibrate(setup_of(commands), capture);
    const calib::AppliedCalibration applied = read_back(result);

    // Recording and undoing it leaves the light where it was, up to the response.
    core::Capture rendered;
    rendered.scan = test_support::confocal_grid(6);
    calib::replace_points(applied, rendered.scan.wall());
    const core::TimeAxis axis{3.0, kBin_m, 200};
    rendered.time_axis = calib::axis_to_render(applied, axis);
    rendered.transient = core::Transient(36, rendered.time_axis.num_bins);
    constexpr double kPath_m = 1.7;
    for (std::size_t p = 0; p < 36; ++p) {
        const int bin = *rendered.time_axis.bin_of(kPath_m);
        rendered.transient.histogram(p)[static_cast<std::size_t>(bin)] = 1.0F;
    }
    core::Capture recorded = calib::record_with(applied, rendered, axis);
    recorded.variance = recorded.transient;  // of light where it was
    const core::Capture undone = calib::apply_calibration(applied, recorded);
    EXPECT_FALSE(undone.variance.has_value());
    for (const std::size_t p : {0U, 20U, 35U}) {
        double sum = 0.0;
        double moment = 0.0;
        for (int b = 0; b < undone.time_axis.num_bins; ++b) {
            const double light =
                static_cast<double>(undone.transient.histogram(p)[static_cast<std::size_t>(b)]);
            sum += light;
            moment += light * undone.time_axis.bin_center_m(b);
        }
        EXPECT_NEAR(sum, 1.0, 1e-4);
        const double bin = *rendered.time_axis.bin_of(kPath_m);
        EXPECT_NEAR(moment / sum, rendered.time_axis.bin_center_m(bin), 1e-4);
    }

    // What was observed moves with the light.
    core::restrict_observed(recorded, {40, 160});
    const core::Capture gated = calib::apply_calibration(applied, recorded);
    core::validate(gated, "gated");
    int num_whole = 0;  // the others begin before the axis
    for (std::size_t p = 0; p < 36; ++p) {
        const core::BinRange range = gated.observed_range(p);
        EXPECT_LE(range.size(), 120);
        if (range.begin > 0) {
            EXPECT_GE(range.size(), 119);
            ++num_whole;
        }
        for (int b = range.begin; b < range.end; ++b) {
            const auto i = static_cast<std::size_t>(b);
            EXPECT_EQ(gated.transient.histogram(p)[i], undone.transient.histogram(p)[i]);
        }
    }
    EXPECT_GT(num_whole, 3);
}

// Counts of a hidden rectangle as the true device records them.
core::Capture counts_through(const Device& device,
                             const std::vector<std::array<double, 2>>& commands,
                             const renderer::SceneGeometry& hidden) {
    std::vector<Vec3> spots;
    for (const auto& command : commands) spots.push_back(spot_of(device, command));
    const core::WallScan scan = test_support::confocal_scan(spots);
    calib::FitSettings settings;
    settings.free.parameters.clear();
    settings.free.objects = {{"target", {"translation"}}};
    const calib::SceneModel model(hidden, settings);
    calib::ForwardSettings forward;
    forward.axis = {2.5, kBin_m, 400};
    forward.sigma_m = kSigma_m;
    forward.offset_m = ranges_of(device, commands);
    calib::ForwardModel light(model, scan, calib::WallMotion(scan), forward);
    light.refresh(model.start());
    light.update(model.start(), renderer::Gradients::Without);
    core::Capture capture;
    capture.scan = test_support::confocal_grid(static_cast<int>(std::sqrt(commands.size())));
    capture.time_axis = forward.axis;
    capture.unit = core::TransientUnit::Counts;
    capture.transient = core::Transient(commands.size(), forward.axis.num_bins);
    std::mt19937_64 engine(test_support::seed_of("CountsThrough"));
    calib::PairModel pair;
    for (std::size_t p = 0; p < commands.size(); ++p) {
        light.evaluate(p, pair);
        for (std::size_t b = 0; b < pair.mean.size(); ++b) {
            constexpr double kCountsPerLight = 2e4;
            capture.transient.histogram(p)[b] = static_cast<float>(
                std::poisson_distribution<int>(0.1 + kCountsPerLight * pair.mean[b])(engine));
        }
    }
    return capture;
}

TEST(Calibrate, AFitThroughTheResultFindsTheHiddenScene) {
    Device device;
    device.tilt_x = 0.5;
    const auto commands = command_grid(8, 0.4);
    const auto peaks = direct_returns(ranges_of(device, commands), 5000.0, 0.0, "FitThrough");
    const calib::Calibration calibration = calib::calibrate(setup_of(commands), peaks);
    const calib::AppliedCalibration applied = read_back(calibration);

    const Vec3 center(0.05, -0.02, 0.7);
    renderer::SceneGeometry hidden;
    hidden.objects = {test_support::tilted_rectangle("target", center, 0.4)};
    const core::Capture counts = counts_through(device, commands, hidden);
    renderer::SceneGeometry start;
    start.objects = {
        test_support::tilted_rectangle("target", center + Vec3(0.03, -0.03, 0.04), 0.3)};
    calib::FitInput input = test_support::fit_input(counts, start);
    calib::replace_points(applied, input.capture.scan.wall());
    input.offset_m = calib::pair_offsets(applied, input.capture.scan.wall());
    input.settings.response = applied.response;
    const calib::FitResult fit = calib::fit_scene(input, {});
    ASSERT_TRUE(fit.converged) << fit.message;
    EXPECT_LT((fit.objects[0].position_m - center).norm(), 0.002);
    // Without the calibration the device's segments are missing, and the light is nowhere near.
    EXPECT_ERROR_WITH(calib::fit_scene(test_support::fit_input(counts, start), {}), "time axis");
}

TEST(Calibrate, BoardsWithoutImagesAreNoCamera) {
    const test_support::TemporaryFolder folder;
    core::write_text_file(folder.file("setup.json"),
                          R"({"direct_returns": "d.h5", "boards": {"images": []}})");
    EXPECT_FALSE(calib::read_setup(folder.file("setup.json"), {}).boards);
}

TEST(Calibrate, ListsOfDifferentLengthsAreNamed) {
    const auto commands = command_grid(3, 0.4);
    const auto capture = direct_returns({2.0, 2.1}, 100.0, 0.0, "Lengths");
    EXPECT_ERROR_WITH(calib::calibrate(setup_of(commands), capture), "commands: found 9");
}

}  // namespace
