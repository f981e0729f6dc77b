// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/volume_noise.h"

#include "renderer/core/random.h"
#include "renderer/core/types.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

namespace nlos {
namespace {

constexpr std::size_t kNoiseColumns = 1600;
constexpr std::size_t kNoiseDepths = 20;
constexpr double kNoiseSigma = 0.5;

std::complex<double> complex_deviate(core::Rng& rng) {
    const double radius = kNoiseSigma * std::sqrt(-2.0 * std::log(1.0 - rng.uniform()));
    return std::polar(radius, 2.0 * core::kPi * rng.uniform());
}

/// Noise as a method shows it: cut off at 0, or the magnitude of a complex field.
float shown(std::complex<double> noise, VolumeScale scale) {
    return static_cast<float>(scale == VolumeScale::Magnitude ? std::abs(noise)
                                                              : std::max(0.0, noise.real()));
}

class NoiseVolume : public testing::TestWithParam<VolumeScale> {
 protected:
    void SetUp() override {
        core::Rng rng(5, 6, 7);
        volume_.axes.x_m = cell_centers(0.0, 1.0, 40);
        volume_.axes.y_m = volume_.axes.x_m;
        volume_.axes.z_m = cell_centers(0.0, 1.0, kNoiseDepths);
        again_.axes = volume_.axes;
        for (std::size_t i = 0; i < kNoiseColumns * kNoiseDepths; ++i) {
            const std::complex<double> noise = complex_deviate(rng);
            volume_.values.push_back(shown(noise, GetParam()));
            again_.values.push_back(shown(noise + complex_deviate(rng), GetParam()));
        }
    }

    Volume volume_;
    Volume again_;
};

TEST_P(NoiseVolume, ItsDeviationIsFound) {
    const VolumeNoise noise(volume_, again_, GetParam());
    for (std::size_t iz = 0; iz < kNoiseDepths; ++iz) {
        EXPECT_NEAR(noise.sigma(iz), kNoiseSigma, 0.15 * kNoiseSigma) << iz;
    }
}

TEST_P(NoiseVolume, ColumnsExceedAChanceNoMoreOftenThanItSays) {
    const VolumeNoise noise(volume_, again_, GetParam());
    for (const double chance : {0.3, 0.1, 0.03}) {
        const double limit = noise.significance_of_chance(chance);
        EXPECT_NEAR(noise.chance_in_column(limit), chance, 1e-6);
        int num_above = 0;
        for (std::size_t column = 0; column < kNoiseColumns; ++column) {
            double largest = 0.0;
            for (std::size_t iz = 0; iz < kNoiseDepths; ++iz) {
                const float value = volume_.values[column * kNoiseDepths + iz];
                largest = std::max(largest, noise.significance(brightness_of(value), iz));
            }
            num_above += largest > limit ? 1 : 0;
        }
        EXPECT_LT(num_above, 1.2 * chance * kNoiseColumns) << chance;
        EXPECT_GT(num_above, 0.05 * chance * kNoiseColumns) << chance;
    }
}

INSTANTIATE_TEST_SUITE_P(BothScales,
                         NoiseVolume,
                         testing::Values(VolumeScale::Amplitude, VolumeScale::Magnitude));

}  // namespace
}  // namespace nlos
