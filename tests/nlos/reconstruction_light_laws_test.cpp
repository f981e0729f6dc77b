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
// from elsewhere. bp, fbp and, above 0, lct and fk are linear; phasor shows the magnitude of a
// field that is; all others are of the first power: twice the light, twice the volume.

namespace nlos {
namespace {

using core::Vec3;
using nlos_test::ReconstructionLaw;

const Vec3 kFirstPoint(0.06, -0.1, 0.55);
const Vec3 kSecondPoint(-0.1, 0.14, 0.66);

TEST_P(ReconstructionLaw, TwiceTheLightIsTwiceTheVolume) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, kFirstPoint, 4.0);
    nlos_test::add_scatterer(capture, kSecondPoint, 4.0);
    std::vector<float> once = run(capture).volume.values;
    for (float& value : capture.transient.values()) value *= 2.0F;
    for (float& value : once) value *= 2.0F;
    EXPECT_LT(test_support::relative_l2(run(capture).volume.values, once), 1e-5);
}

TEST_P(ReconstructionLaw, SumsOfScenesAreSums) {
    if (!GetParam().is_linear && !GetParam().is_wave()) return;
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, kFirstPoint, 4.0);
    const core::Transient first = capture.transient;
    const std::vector<float> a = run(capture).volume.values;
    capture.transient = core::Transient(capture.scan.num_pairs(), capture.time_axis.num_bins);
    nlos_test::add_scatterer(capture, kSecondPoint, 4.0);
    const core::Transient second = capture.transient;
    const std::vector<float> b = run(capture).volume.values;
    const auto with_second = [&](float fraction) {
        for (std::size_t i = 0; i < first.values().size(); ++i) {
            capture.transient.values()[i] = first.values()[i] + fraction * second.values()[i];
        }
        return run(capture).volume.values;
    };
    const std::vector<float> sum = with_second(1.0F);
    const double brightest = *std::ranges::max_element(sum);
    if (GetParam().is_linear) {
        for (std::size_t i = 0; i < sum.size(); ++i) {
            if (GetParam().is_non_negative && (a[i] == 0.0F || b[i] == 0.0F)) continue;
            ASSERT_NEAR(sum[i], a[i] + b[i], 1e-5 * brightest);
        }
        return;
    }
    // Magnitudes tell by the parallelogram law whether their field is linear.
    const std::vector<float> difference = with_second(-1.0F);
    const auto square = [](float value) { return double{value} * double{value}; };
    for (std::size_t i = 0; i < sum.size(); ++i) {
        ASSERT_NEAR(square(sum[i]) + square(difference[i]),
                    2.0 * (square(a[i]) + square(b[i])),
                    1e-5 * brightest * brightest);
    }
}

TEST_P(ReconstructionLaw, DarknessIsDark) {
    const Reconstruction result = run(dark_capture());
    for (const float value : result.volume.values) ASSERT_EQ(value, 0.0F);
    EXPECT_TRUE(result.points.positions.empty());
}

TEST_P(ReconstructionLaw, LightOfAnyMagnitudeGivesTheSameVolume) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, kFirstPoint, 4.0);
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
    nlos_test::add_scatterer(capture, kFirstPoint, 4.0);
    const std::vector<float> positive = run(capture).volume.values;
    for (float& value : capture.transient.values()) value = -value;
    const std::vector<float> negative = run(capture).volume.values;
    const auto brightest =
        static_cast<std::size_t>(std::ranges::max_element(positive) - positive.begin());
    if (GetParam().is_wave()) {
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
    const MethodTraits* method = GetParam().method.traits;
    if (method != &kBp && method != &kLct) return;
    for (const float value : result.volume.values) ASSERT_EQ(value, 0.0F);
}

}  // namespace
}  // namespace nlos
