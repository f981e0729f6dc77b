// SPDX-License-Identifier: MIT
// Calibrations of what is not as its files say: never values that look sure; silence on sound data.
#include "calib/calibrate.h"
#include "renderer/core/system/output_file.h"
#include "tests/calib/setup/simulated_setup.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>

namespace {

using calib::KnownValue;
using setup_test::command_grid;
using setup_test::Device;
using setup_test::direct_returns;
using setup_test::ranges_of;
using setup_test::setup_of;

/// A set-up of 8 x 8 beams before a tilted wall, sound until a test changes it.
struct Example {
    Device device{.tilt_x = 0.5};
    std::vector<std::array<double, 2>> commands = command_grid(8, 0.3);
    calib::SetupSettings settings = setup_of(commands);
    core::Capture capture = direct_returns(ranges_of(device, commands), 1000.0, 0.0, "Example");

    Example() { settings.known.wall_distance_m = KnownValue{1.0, 0.002}; }

    /// Records path lengths that are not those of the device.
    void record(const std::vector<double>& opl_m) {
        capture = direct_returns(opl_m, 1000.0, 0.0, "Recorded");
    }
    calib::Calibration run() const { return calib::calibrate(settings, capture); }
    /// What the refusal says; empty when there is none.
    std::string refusal() const {
        try {
            run();
        } catch (const core::Failure& failure) {
            return failure.what();
        }
        return "";
    }
};

#define EXPECT_SAYS(text, part)                                   \
    EXPECT_PRED2(                                                 \
        [](const std::string& whole, const std::string& wanted) { \
            return whole.find(wanted) != std::string::npos;       \
        },                                                        \
        std::string(text),                                        \
        std::string(part))

TEST(SetupChecks, SoundSetUpsAreTakenInSilence) {
    int grown = 0;
    int count = 0;
    for (const double photons : {60.0, 300.0, 1000.0, 30000.0}) {
        for (const double tilt : {0.3, 0.6}) {
            for (const int grid : {4, 8}) {
                Device device{.distance_m = 0.8 + tilt, .tilt_x = tilt, .tilt_y = 0.2};
                const auto commands = command_grid(grid, 0.3);
                calib::SetupSettings settings = setup_of(commands);
                settings.known.wall_distance_m = KnownValue{device.distance_m, 0.002};
                const std::string seed = std::to_string(count++);
                const auto result = calib::calibrate(
                    settings,
                    direct_returns(ranges_of(device, commands), photons, 0.0, seed.c_str()));
                EXPECT_TRUE(result.warnings().empty()) << seed << ": " << result.warnings()[0];
                EXPECT_TRUE(result.setup.verdict.outliers.empty());
                grown += result.setup.verdict.sigma_scale > 1.0 ? 1 : 0;
            }
        }
    }
    EXPECT_EQ(grown, 0);
}

TEST(SetupChecks, LightSortedIntoBinsBeforeTheResponseIsSound) {
    Example example;
    std::vector<double> opl_m = ranges_of(example.device, example.commands);
    for (double& opl : opl_m)
        opl = example.capture.time_axis.bin_center_m(
            std::floor((opl - example.capture.time_axis.opl_start_m) / setup_test::kBin_m));
    example.record(opl_m);
    EXPECT_TRUE(example.run().warnings().empty());
}

TEST(SetupChecks, ShuffledCommandsDoNotBelongToTheReturns) {
    Example example;
    std::mt19937_64 engine(1);
    std::ranges::shuffle(example.settings.commands, engine);
    EXPECT_SAYS(example.refusal(), "do not belong together");
}

TEST(SetupChecks, TimeThatRunsBackwardsIsNamed) {
    for (const bool is_known : {true, false}) {
        Example example;
        for (std::size_t p = 0; p < example.commands.size(); ++p) {
            std::ranges::reverse(example.capture.transient.histogram(p));
        }
        if (!is_known) example.settings.known = {};
        EXPECT_SAYS(example.refusal(), "time looks reversed");
        EXPECT_SAYS(example.refusal(), "capture.flip_t=true");
    }
}

TEST(SetupChecks, OtherUnitsAreTriedAndNamed) {
    const auto scaled = [](double factor) {
        return [factor](Example& e) {
            for (auto& command : e.settings.commands) {
                for (double& angle : command) angle *= factor;
            }
        };
    };
    const auto of_axis = [](double factor) {
        return [factor](Example& e) {
            e.capture.time_axis.opl_start_m *= factor;
            e.capture.time_axis.bin_width_m *= factor;
        };
    };
    const std::vector<std::pair<std::function<void(Example&)>, std::string>> cases{
        {scaled(180.0 / core::kPi), "command_unit=deg"},
        {scaled(1e3), "command_unit=mrad"},
        {of_axis(1e3), "millimetres"},
        {of_axis(1e9 / core::kSpeedOfLight), "nanoseconds"},
        {of_axis(1e12 / core::kSpeedOfLight), "picoseconds"},
        {[](Example& e) {
             e.settings.known.wall_distance_m = KnownValue{1000.0, 2.0};
         },
         "known.wall_distance_m looks like millimetres"},
    };
    for (const auto& [change, part] : cases) {
        Example example;
        change(example);
        EXPECT_SAYS(example.refusal(), part);
    }
}

TEST(SetupChecks, AnAxisInMillimetresIsNamedByItsPeaksToo) {
    Example example;
    example.settings.known = {};
    example.capture.time_axis.opl_start_m *= 1e3;
    example.capture.time_axis.bin_width_m *= 1e3;
    const auto warnings = example.run().warnings();
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_SAYS(warnings[0], "as no pulse is");
}

TEST(SetupChecks, CommandsInDegreesAreTakenWhenStated) {
    Example example;
    for (auto& command : example.settings.commands) {
        for (double& angle : command) angle *= 180.0 / core::kPi;
    }
    example.settings.command_unit = calib::CommandUnit::Deg;
    const calib::Calibration result = example.run();
    EXPECT_NEAR(result.setup.values[1], 0.5, 5.0 * result.setup.sigma[1]);
    EXPECT_TRUE(result.warnings().empty());
}

TEST(SetupChecks, RowsRecordedBackAndForthAreNamed) {
    Example example;
    example.device.tilt_y = 0.3;
    std::vector<double> opl_m = ranges_of(example.device, example.commands);
    for (std::size_t row = 1; row < 8; row += 2) {
        std::reverse(opl_m.begin() + static_cast<std::ptrdiff_t>(8 * row),
                     opl_m.begin() + static_cast<std::ptrdiff_t>(8 * row + 8));
    }
    example.record(opl_m);
    EXPECT_SAYS(example.refusal(), "back and forth");
}

TEST(SetupChecks, AKnownValueThatTheRestContradictsIsNamed) {
    for (const double value : {1.3, 2.7}) {
        Example example;
        example.settings.known.wall_distance_m = KnownValue{value, 0.002};
        EXPECT_SAYS(example.refusal(), "known.wall_distance_m of");
    }
    Example near;
    near.settings.known.time_zero_m = KnownValue{setup_test::kZero_m + 0.025, 0.002};
    const auto warnings = near.run().warnings();
    ASSERT_FALSE(warnings.empty());
    EXPECT_SAYS(warnings[0], "standard deviations");
}

TEST(SetupChecks, PointsFarOffAreNamedAndLeftOutOnRequest) {
    Example example;
    std::vector<double> opl_m = ranges_of(example.device, example.commands);
    opl_m[5] += 0.05;
    opl_m[40] -= 0.2;
    opl_m[63] += 0.9;
    example.record(opl_m);
    const calib::Calibration with = example.run();
    ASSERT_EQ(with.warnings().size(), 1U);
    EXPECT_SAYS(with.warnings()[0], "3 of 64 points");
    EXPECT_SAYS(with.warnings()[0], "5 by +50");
    EXPECT_SAYS(with.warnings()[0], "outliers=leave_out");
    EXPECT_GT(with.setup.verdict.sigma_scale, 10.0);

    example.settings.outliers = calib::OutlierRule::LeaveOut;
    const calib::Calibration without = example.run();
    EXPECT_EQ(without.setup.verdict.outliers, (std::vector<std::size_t>{5, 40, 63}));
    EXPECT_EQ(without.setup.verdict.sigma_scale, 1.0);
    EXPECT_NEAR(without.setup.values[1], 0.5, 5.0 * without.setup.sigma[1]);
    EXPECT_LT(without.setup.sigma[1], 0.05 * with.setup.sigma[1]);
}

TEST(SetupChecks, StatedErrorsGrowWithAMisfitThatNobodyNamed) {
    Example example;
    const calib::Calibration sound = example.run();
    std::vector<double> opl_m = ranges_of(example.device, example.commands);
    for (std::size_t i = 0; i < opl_m.size(); ++i) {
        opl_m[i] +=
            0.01 * std::cos(9.0 * example.commands[i][0]) * std::sin(8.0 * example.commands[i][1]);
    }
    example.record(opl_m);
    const calib::Calibration bowed = example.run();
    ASSERT_EQ(bowed.warnings().size(), 1U);
    EXPECT_SAYS(bowed.warnings()[0], "path lengths are off by");
    const double reduced =
        bowed.setup.verdict.fit.chi_square / bowed.setup.verdict.fit.degrees_of_freedom;
    EXPECT_DOUBLE_EQ(bowed.setup.verdict.sigma_scale, std::sqrt(reduced));
    EXPECT_NEAR(bowed.setup.sigma[1] / sound.setup.sigma[1], std::sqrt(reduced), 0.5);
    EXPECT_NEAR(
        bowed.setup.point_sigma_m[3] / sound.setup.point_sigma_m[3], std::sqrt(reduced), 0.5);
}

TEST(SetupChecks, PeaksOfAnotherShapeAreNamed) {
    Example example;
    example.capture =
        direct_returns(ranges_of(example.device, example.commands), 20000.0, 0.05, "Tail");
    const auto warnings = example.run().warnings();
    ASSERT_FALSE(warnings.empty());
    EXPECT_SAYS(warnings[0], "response=gaussian");
    example.settings.response = calib::ResponseShape::GaussianExponential;
    EXPECT_TRUE(example.run().warnings().empty());
}

TEST(SetupChecks, NumbersThatAreNoCountsAreRefusedOrNamed) {
    Example example;
    example.capture.transient.histogram(3)[12] = -5.0F;
    EXPECT_ERROR_WITH(example.run(), "point 3: found -5 in bin 12");
    for (float& value : example.capture.transient.values()) value = 0.37F * std::abs(value);
    const auto warnings = example.run().warnings();
    ASSERT_FALSE(warnings.empty());
    EXPECT_SAYS(warnings[0], "not whole");
}

TEST(SetupChecks, ClippedPeaksAreRefusedInOurWords) {
    Example example;
    for (float& value : example.capture.transient.values()) value = std::min(value, 1.0F);
    testing::internal::CaptureStderr();
    EXPECT_SAYS(example.refusal(), "64 of 64 peaks are clipped: they are flat at 1");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
