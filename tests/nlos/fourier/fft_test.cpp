// SPDX-License-Identifier: MIT
#include "nlos/fourier/even_transform.h"
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
    const std::size_t row_floats = Fft::row_floats(kLength);
    FftBuffer buffer(row_floats * kCount);
    const auto value = [](std::size_t row, std::size_t i) {
        return static_cast<float>(std::sin(1.0 + static_cast<double>(i * i + 7 * row)));
    };
    for (std::size_t row = 0; row < kCount; ++row) {
        for (std::size_t i = 0; i < kLength; ++i) {
            buffer.data()[row * row_floats + i] = value(row, i);
        }
    }
    Fft::real_to_complex(kLength, kCount).run(buffer);
    Fft::complex_to_real(kLength, kCount).run(buffer);
    for (std::size_t row = 0; row < kCount; ++row) {
        for (std::size_t i = 0; i < kLength; ++i) {
            EXPECT_NEAR(buffer.data()[row * row_floats + i], kLength * value(row, i), 1e-4);
        }
    }
}

TEST(EvenTransform, EqualsTheTransformOfTheWholePeriod) {
    for (const auto& [nx, ny] :
         {std::array{2UL, 2UL}, std::array{4UL, 3UL}, std::array{9UL, 33UL}}) {
        const std::size_t period_x = 2 * (nx - 1);
        const std::size_t period_y = 2 * (ny - 1);
        std::vector<ComplexF> values;
        for (std::size_t i = 0; i < nx * ny; ++i) {
            values.emplace_back(static_cast<float>(i % 5), static_cast<float>(i % 3) - 1.0F);
        }
        const std::vector<std::complex<double>> quadrant(values.begin(), values.end());
        const EvenTransform transform(nx, ny);
        EvenTransform::Workspace work = transform.make_workspace();
        transform.run(values.data(), work);
        for (std::size_t kx = 0; kx < nx; ++kx) {
            for (std::size_t ky = 0; ky < ny; ++ky) {
                std::complex<double> expected = 0.0;
                for (std::size_t x = 0; x < period_x; ++x) {
                    for (std::size_t y = 0; y < period_y; ++y) {
                        const auto at =
                            quadrant[std::min(x, period_x - x) * ny + std::min(y, period_y - y)];
                        const double turns =
                            static_cast<double>(kx * x) / static_cast<double>(period_x) +
                            static_cast<double>(ky * y) / static_cast<double>(period_y);
                        expected += at * std::polar(1.0, -2.0 * core::kPi * turns);
                    }
                }
                const std::complex<double> found(values[ky * nx + kx]);
                EXPECT_LT(std::abs(found - expected), 2e-6 * static_cast<double>(nx * ny) + 1e-4);
            }
        }
    }
}

}  // namespace
}  // namespace nlos
