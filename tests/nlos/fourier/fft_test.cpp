// SPDX-License-Identifier: MIT
#include "nlos/fourier/fft.h"

#include "renderer/core/types.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace nlos {
namespace {

TEST(Fft, GoodSizesHaveSmallPrimeFactors) {
    EXPECT_EQ(good_fft_size(1), 1U);
    EXPECT_EQ(good_fft_size(11), 12U);
    EXPECT_EQ(good_fft_size(64), 64U);
    EXPECT_EQ(good_fft_size(127), 128U);
    EXPECT_EQ(good_fft_size(211), 216U);
}

TEST(Fft, RealTransformAndItsInverseMultiplyByTheLength) {
    constexpr std::size_t kLength = 30;
    constexpr std::size_t kCount = 3;
    FftBuffer buffer((kLength + 2) * kCount);
    const auto value = [](std::size_t row, std::size_t i) {
        return static_cast<float>(std::sin(1.0 + static_cast<double>(i * i + 7 * row)));
    };
    for (std::size_t row = 0; row < kCount; ++row) {
        for (std::size_t i = 0; i < kLength; ++i) {
            buffer.data()[row * (kLength + 2) + i] = value(row, i);
        }
    }
    Fft::real_to_complex(kLength, kCount).run(buffer);
    Fft::complex_to_real(kLength, kCount).run(buffer);
    for (std::size_t row = 0; row < kCount; ++row) {
        for (std::size_t i = 0; i < kLength; ++i) {
            EXPECT_NEAR(buffer.data()[row * (kLength + 2) + i], kLength * value(row, i), 1e-4);
        }
    }
}

TEST(Fft, EvenTransformEqualsTheTransformOfTheWholePeriod) {
    constexpr std::size_t kX = 4;
    constexpr std::size_t kY = 3;
    constexpr std::size_t kPeriodX = 2 * (kX - 1);
    constexpr std::size_t kPeriodY = 2 * (kY - 1);
    FftBuffer buffer(2 * kX * kY);
    std::vector<std::complex<double>> quadrant;
    for (std::size_t i = 0; i < kX * kY; ++i) {
        buffer.complex()[i] = {static_cast<float>(i % 5), static_cast<float>(i % 3) - 1.0F};
        quadrant.emplace_back(buffer.complex()[i]);
    }
    Fft::even_2d(kX, kY).run(buffer);
    for (std::size_t kx = 0; kx < kX; ++kx) {
        for (std::size_t ky = 0; ky < kY; ++ky) {
            std::complex<double> expected = 0.0;
            for (std::size_t x = 0; x < kPeriodX; ++x) {
                for (std::size_t y = 0; y < kPeriodY; ++y) {
                    const auto at =
                        quadrant[std::min(x, kPeriodX - x) * kY + std::min(y, kPeriodY - y)];
                    const double turns = static_cast<double>(kx * x) / kPeriodX +
                                         static_cast<double>(ky * y) / kPeriodY;
                    expected += at * std::polar(1.0, -2.0 * core::kPi * turns);
                }
            }
            const std::complex<double> found(buffer.complex()[kx * kY + ky]);
            EXPECT_LT(std::abs(found - expected), 1e-4);
        }
    }
}

}  // namespace
}  // namespace nlos
