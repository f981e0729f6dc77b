// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"
#include "tests/nlos/every_method.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

// Captures at the edge of sense, each given to every method: a finite volume or a clear refusal.

namespace nlos {
namespace {

using core::Vec3;
using nlos_test::brightest_point;

class HardCapture : public testing::TestWithParam<nlos_test::MethodCase> {
 protected:
    static core::Capture dark_capture(std::array<std::size_t, 2> size,
                                      std::array<double, 2> pitch_m = {0.05, 0.05},
                                      const core::TimeAxis& axis = {0.0, 0.02, 96},
                                      const core::Transform& pose = core::Transform::Identity()) {
        return nlos_test::confocal_capture(nlos_test::wall_grid(size, pitch_m, pose), axis);
    }

    static Reconstruction run(const core::Capture& capture) {
        const bool has_filter = GetParam().traits->has_wiener_filter;
        const auto settings = GetParam().settings(has_filter ? std::vector<std::string>{"snr=10"}
                                                             : std::vector<std::string>{});
        return reconstruct(capture, settings, {});
    }

    static Reconstruction expect_finite(const core::Capture& capture, const char* what) {
        const Reconstruction result = run(capture);
        EXPECT_EQ(result.volume.values.size(), result.volume.axes.num_voxels()) << what;
        const bool is_finite =
            std::ranges::all_of(result.volume.values, [](float v) { return std::isfinite(v); });
        EXPECT_TRUE(is_finite) << what;
        return result;
    }
};

TEST_P(HardCapture, OnePixelWall) {
    core::Capture capture = dark_capture({1, 1});
    nlos_test::add_scatterer(capture, Vec3(0.0, 0.0, 0.4), 4.0);
    if (GetParam().traits->needs) {
        EXPECT_ERROR_WITH(run(capture), "method=bp works for this capture");
    } else {
        expect_finite(capture, "one point");
    }
}

TEST_P(HardCapture, ThreeByThreeWall) {
    core::Capture capture = dark_capture({3, 3});
    nlos_test::add_scatterer(capture, Vec3(0.0, 0.0, 0.4), 4.0);
    const Reconstruction result = expect_finite(capture, "3 x 3");
    EXPECT_GT(*std::ranges::max_element(result.volume.values), 0.0F);
}

TEST_P(HardCapture, OneLineOfPoints) {
    core::Capture capture = dark_capture({12, 1});
    nlos_test::add_scatterer(capture, Vec3(0.0, 0.0, 0.4), 4.0);
    if (GetParam().traits->needs == &kConfocalGrid) {
        EXPECT_ERROR_WITH(run(capture), "works for this capture");
    } else {
        expect_finite(capture, "a line");
    }
}

TEST_P(HardCapture, OneBin) {
    core::Capture capture = dark_capture({8, 8}, {0.05, 0.05}, {0.8, 0.2, 1});
    for (float& value : capture.transient.values()) value = 1.0F;
    if (GetParam().traits->needs) {
        EXPECT_ERROR_WITH(run(capture), "method=bp works for this capture");
    } else {
        expect_finite(capture, "one bin");
    }
}

TEST_P(HardCapture, DarknessAndAnObjectBeyondTheAxis) {
    core::Capture capture = dark_capture({8, 8});
    nlos_test::add_scatterer(capture, Vec3(0.0, 0.0, 5.0), 4.0);
    for (const core::TransientUnit unit :
         {core::TransientUnit::Radiance, core::TransientUnit::Counts}) {
        capture.unit = unit;
        const Reconstruction result = expect_finite(capture, "darkness");
        EXPECT_TRUE(result.points.positions.empty());
        for (const float value : result.volume.values) ASSERT_EQ(value, 0.0F);
    }
}

TEST_P(HardCapture, AxisThatEndsBeforeTheWall) {
    core::Capture capture = dark_capture({8, 8}, {0.05, 0.05}, {-3.0, 0.02, 96});
    EXPECT_ERROR_WITH(run(capture), "must reach beyond the wall");
}

TEST_P(HardCapture, OneCountInTheLastBin) {
    core::Capture capture = dark_capture({8, 8});
    capture.unit = core::TransientUnit::Counts;
    capture.transient.histogram(27).back() = 1.0F;
    expect_finite(capture, "last bin");
}

TEST_P(HardCapture, ValuesThatAreNoNumbers) {
    for (const float value :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        core::Capture capture = dark_capture({8, 8});
        capture.transient.histogram(9)[17] = value;
        EXPECT_ERROR_WITH(run(capture), "capture");
    }
}

TEST_P(HardCapture, NegativeValues) {
    core::Capture capture = dark_capture({8, 8});
    nlos_test::add_scatterer(capture, Vec3(0.025, 0.025, 0.4), 4.0);
    for (float& value : capture.transient.values()) value -= 0.5F;
    expect_finite(capture, "negative values");
}

TEST_P(HardCapture, SaturatedCounts) {
    core::Capture capture = dark_capture({8, 8});
    capture.unit = core::TransientUnit::Counts;
    nlos_test::add_scatterer(capture, Vec3(0.025, 0.025, 0.4), 4.0);
    for (float& value : capture.transient.values()) value = value > 0.0F ? 65535.0F : 0.0F;
    expect_finite(capture, "saturated peaks");
    for (float& value : capture.transient.values()) value = 65535.0F;
    expect_finite(capture, "everything saturated");
}

TEST_P(HardCapture, UnequalPitchOnATurnedWallElsewhere) {
    core::Transform pose = core::Transform::Identity();
    pose.translate(Vec3(-2.0, 0.7, 4.0));
    pose.rotate(Eigen::AngleAxisd(2.6, Vec3(1.0, -0.4, 0.3).normalized()));
    core::Capture capture = dark_capture({12, 20}, {0.06, 0.03}, {0.0, 0.02, 96}, pose);
    const Vec3 scatterer = pose * Vec3(0.03, -0.045, 0.42);
    nlos_test::add_scatterer(capture, scatterer, 4.0);
    EXPECT_LT((brightest_point(expect_finite(capture, "unequal pitch")) - scatterer).norm(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         HardCapture,
                         testing::ValuesIn(nlos_test::every_method()),
                         [](const auto& method) { return method.param.name; });

}  // namespace
}  // namespace nlos
