// SPDX-License-Identifier: MIT
// Velocities in captures of the HDF5 layout of y-tal.
#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/nlos/formats/ytal_capture_file.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace nlos {
namespace {

using core::Capture;
using core::ScanPattern;
using test_support::example_capture;
using test_support::TemporaryFolder;

// A capture with velocities, every value different.
Capture with_velocities(Capture capture, bool with_time) {
    core::VelocityAxis axis{-1.5, 0.25, 4, with_time, 24e9};
    const int num_values = axis.num_values(capture.time_axis.num_bins);
    capture.velocity = {axis, core::Transient(capture.scan.num_pairs(), num_values), std::nullopt};
    float next = 0.0F;
    for (float& value : capture.velocity->values.values()) value = next += 0.5F;
    capture.velocity->variance = capture.velocity->values;
    return capture;
}

TEST(YtalVelocity, VelocitiesSurviveTheRoundTrip) {
    for (const bool with_time : {false, true}) {
        for (const Capture& plain :
             {example_capture(ScanPattern::Exhaustive), test_support::example_image()}) {
            const Capture capture = with_velocities(plain, with_time);
            const Capture read = CaptureFile(capture).read();
            ASSERT_TRUE(read.velocity.has_value());
            EXPECT_EQ(core::write_value(read.velocity->axis),
                      core::write_value(capture.velocity->axis));
            EXPECT_TRUE(std::ranges::equal(read.velocity->values.values(),
                                           capture.velocity->values.values()));
            EXPECT_TRUE(std::ranges::equal(read.velocity->variance->values(),
                                           capture.velocity->variance->values()));
        }
    }
}

TEST(YtalVelocity, VelocityIsSlowestBeforeTime) {
    const Capture capture = with_velocities(test_support::example_image(), true);
    const CaptureFile file(capture);
    const ArrayReader reader(file.path());
    ASSERT_EQ(reader.shape("nlos/velocity"), (Shape{4, 5, 3, 2}));
    const auto values = reader.read_floats("nlos/velocity", {4, 5, 3, 2});
    // Velocity 3, time 1, x 2, y 1 is pair 2 * 2 + 1 and bin 3 * 5 + 1.
    EXPECT_EQ(values[((3 * 5 + 1) * 3 + 2) * 2 + 1],
              capture.velocity->values.histogram(5)[3 * 5 + 1]);
    const Capture alone = with_velocities(test_support::example_image(), false);
    const CaptureFile other(alone);
    EXPECT_EQ(ArrayReader(other.path()).shape("nlos/velocity"), (Shape{4, 3, 2}));
}

TEST(YtalVelocity, VelocitiesWithoutAnAxisAreRefused) {
    Capture capture = with_velocities(example_capture(ScanPattern::Confocal), false);
    capture.velocity->axis.num_bins = 3;
    const TemporaryFolder folder;
    EXPECT_ERROR_WITH(write_capture(folder.file("a.h5"), capture), "velocity: found 6 pairs x 4");
    capture.velocity->axis = {0.0, -1.0, 4};
    EXPECT_ERROR_WITH(write_capture(folder.file("a.h5"), capture), "bin_width_m_per_s: found -1");
}

TEST(YtalVelocity, DescriptionGivesVelocitiesAndFrequencyShifts) {
    std::string text;
    const Capture capture = with_velocities(example_capture(ScanPattern::Confocal), true);
    for (const auto& line : describe_capture(capture)) text += line;
    EXPECT_NE(text.find("path velocity with time: 4 bins of 0.25 m/s, from -1.5 to -0.5 m/s"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("at 2.4e+10 Hz a shift from 120.083 to 40.0277 Hz"), std::string::npos);
}

}  // namespace
}  // namespace nlos
