// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/nlos/reconstruction_law.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

// What must hold for every method whatever the light: none, twice as much, too much, negative, or
// from elsewhere. bp, fbp and, above 0, lct are linear; fk and phasor show the magnitude of a field
// that is; all others are of the first power: twice the light, twice the volume.

namespace nlos {
namespace {

using core::Vec3;
using nlos_test::ReconstructionLaw;

TEST_P(ReconstructionLaw, TwiceTheLightIsTwiceTheVolume) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, Vec3(0.06, -0.1, 0.55), 4.0);
    nlos_test::add_scatterer(capture, Vec3(-0.1, 0.14, 0.66), 4.0);
    std::vector<float> once = run(capture).volume.values;
    for (float& value : capture.transient.values()) value *= 2.0F;
    for (float& value : once) value *= 2.0F;
    EXPECT_LT(test_support::relative_l2(run(capture).volume.values, once), 1e-5);
}

TEST_P(ReconstructionLaw, SumsOfScenesAreSumsOfVolumes) {
    if (!GetParam().is_linear) return;
    core::Capture first = dark_capture();
    core::Capture second = dark_capture();
    nlos_test::add_scatterer(first, Vec3(0.06, -0.1, 0.55), 4.0);
    nlos_test::add_scatterer(second, Vec3(-0.1, 0.14, 0.66), 4.0);
    const std::vector<float> a = run(first).volume.values;
    const std::vector<float> b = run(second).volume.values;
    for (std::size_t i = 0; i < first.transient.values().size(); ++i) {
        first.transient.values()[i] += second.transient.values()[i];
    }
    const std::vector<float> both = run(first).volume.values;
    const float tolerance = 1e-5F * *std::ranges::max_element(both);
    for (std::size_t i = 0; i < both.size(); ++i) {
        if (GetParam().is_non_negative && (a[i] == 0.0F || b[i] == 0.0F)) continue;
        ASSERT_NEAR(both[i], a[i] + b[i], tolerance);
    }
}

// The parallelogram law: magnitudes alone tell whether their field is linear.
TEST_P(ReconstructionLaw, SumsOfScenesAreSumsOfFields) {
    if (!GetParam().shows_magnitudes()) return;
    core::Capture first = dark_capture();
    core::Capture second = dark_capture();
    nlos_test::add_scatterer(first, Vec3(0.06, -0.1, 0.55), 4.0);
    nlos_test::add_scatterer(second, Vec3(-0.1, 0.14, 0.66), 4.0);
    const std::vector<float> a = run(first).volume.values;
    const std::vector<float> b = run(second).volume.values;
    for (std::size_t i = 0; i < first.transient.values().size(); ++i) {
        first.transient.values()[i] += second.transient.values()[i];
    }
    const std::vector<float> sum = run(first).volume.values;
    for (std::size_t i = 0; i < first.transient.values().size(); ++i) {
        first.transient.values()[i] -= 2.0F * second.transient.values()[i];
    }
    const std::vector<float> difference = run(first).volume.values;
    const auto square = [](float value) { return double{value} * double{value}; };
    const double tolerance = 1e-5 * square(*std::ranges::max_element(sum));
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_NEAR(square(sum[i]) + square(difference[i]),
                    2.0 * (square(a[i]) + square(b[i])),
                    tolerance);
    }
}

TEST_P(ReconstructionLaw, DarknessIsDark) {
    const Reconstruction result = run(dark_capture());
    for (const float value : result.volume.values) ASSERT_EQ(value, 0.0F);
    EXPECT_TRUE(result.points.positions.empty());
}

TEST_P(ReconstructionLaw, LightOfAnyMagnitudeGivesTheSameVolume) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, Vec3(0.06, -0.1, 0.55), 4.0);
    capture.transient.histogram(7).back() = 1.0F;  // a spike in the last bin
    const core::Transient light = capture.transient;
    std::vector<float> expected = run(capture).volume.values;
    for (const float factor : {0x1p-40F, 0x1p+40F}) {
        for (std::size_t i = 0; i < light.values().size(); ++i) {
            capture.transient.values()[i] = factor * light.values()[i];
        }
        std::vector<float> values = run(capture).volume.values;
        for (float& value : values) value /= factor;
        EXPECT_LT(test_support::relative_l2(values, expected), 1e-5) << factor;
    }
}

TEST_P(ReconstructionLaw, SaturationIsNoMoreThanMuchLight) {
    core::Capture capture = dark_capture();
    std::ranges::fill(capture.transient.values(), 1.0F);
    std::vector<float> expected = run(capture).volume.values;
    for (float& value : expected) value *= 65536.0F;
    std::ranges::fill(capture.transient.values(), 65536.0F);
    const Reconstruction saturated = run(capture);
    expect_finite(saturated, "saturation");
    EXPECT_LT(test_support::relative_l2(saturated.volume.values, expected), 1e-5);
}

// Magnitudes do not tell; other volumes change their sign or, where they are cut off, are 0.
TEST_P(ReconstructionLaw, NegativeLightIsNoSurface) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, Vec3(0.06, -0.1, 0.55), 4.0);
    const std::vector<float> positive = run(capture).volume.values;
    for (float& value : capture.transient.values()) value = -value;
    const std::vector<float> negative = run(capture).volume.values;
    const auto brightest =
        static_cast<std::size_t>(std::ranges::max_element(positive) - positive.begin());
    if (GetParam().shows_magnitudes()) {
        EXPECT_LT(test_support::relative_l2(negative, positive), 1e-5);
    } else {
        EXPECT_LE(negative[brightest], 0.0F);
    }
    for (const float value : negative) ASSERT_TRUE(std::isfinite(value));
}

// Transforms, which are periodic, may show some of it; voxels that a method asks for their light
// have none.
TEST_P(ReconstructionLaw, LightFromBehindTheVolumeIsNotInIt) {
    core::Capture capture = dark_capture();
    capture.time_axis.opl_start_m = 5.0;
    std::ranges::fill(capture.transient.values(), 1.0F);
    const Reconstruction result = run(capture);
    expect_finite(result, "an axis behind the volume");
    const std::string& name = GetParam().name;
    if (!name.starts_with("Bp") && !name.starts_with("Lct")) return;
    for (const float value : result.volume.values) ASSERT_EQ(value, 0.0F);
}

}  // namespace
}  // namespace nlos
