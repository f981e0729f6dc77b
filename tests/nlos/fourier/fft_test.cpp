// SPDX-License-Identifier: MIT
#include "nlos/fourier/even_transform.h"
#include "nlos/fourier/padded_plane.h"
#include "nlos/fourier/plane_rows.h"
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

TEST(Fft, RowsAreAnOddNumberOfCacheLinesApart) {
    for (const std::size_t floats : {1U, 16U, 17U, 32U, 1024U, 2050U}) {
        const std::size_t stride = row_stride(floats);
        EXPECT_GE(stride, floats);
        EXPECT_LT(stride, floats + 32);
        EXPECT_EQ(stride % 32, 16U);
    }
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
    FftBuffer spectra(buffer.num_floats());
    Fft::real_to_complex(kLength, kCount).run(buffer, spectra);
    Fft::complex_to_real(kLength, kCount).run(spectra, buffer);
    for (std::size_t row = 0; row < kCount; ++row) {
        for (std::size_t i = 0; i < kLength; ++i) {
            EXPECT_NEAR(buffer.data()[row * row_floats + i], kLength * value(row, i), 1e-4);
        }
    }
}

using Complex = std::complex<double>;

/// sum_xy f(x, y) exp(-2 pi i (kx x / px + ky y / py)) of values (nx, ny).
Complex spectrum_at(const std::vector<ComplexF>& values,
                    std::array<std::size_t, 2> size,
                    std::array<std::size_t, 2> padded,
                    std::size_t kx,
                    std::size_t ky) {
    Complex sum = 0.0;
    for (std::size_t x = 0; x < size[0]; ++x) {
        for (std::size_t y = 0; y < size[1]; ++y) {
            const double turns = static_cast<double>(kx * x) / static_cast<double>(padded[0]) +
                                 static_cast<double>(ky * y) / static_cast<double>(padded[1]);
            sum += Complex(values[x * size[1] + y]) * std::polar(1.0, -2.0 * core::kPi * turns);
        }
    }
    return sum;
}

struct SmallPlane {
    std::array<std::size_t, 2> size{3, 5};
    std::array<std::size_t, 2> padded;
    PaddedPlane plane{size, padded};
    PaddedPlane::Workspace work = plane.make_workspace();
    std::vector<ComplexF> values;

    explicit SmallPlane(std::array<std::size_t, 2> padded_size = {8, 12}) : padded(padded_size) {
        for (std::size_t i = 0; i < size[0] * size[1]; ++i) {
            values.emplace_back(static_cast<float>(i % 4), static_cast<float>(i % 7) - 3.0F);
        }
    }
};

void expect_spectra_there_and_back(SmallPlane small) {
    for (int repeat = 0; repeat < 2; ++repeat) {  // the workspace keeps nothing of the first
        small.plane.load(small.values.data(), small.work);
        small.plane.forward(small.work);
        for (std::size_t ky = 0; ky < small.padded[1]; ++ky) {
            for (std::size_t kx = 0; kx < small.padded[0]; ++kx) {
                const Complex found(small.plane.spectrum_row(small.work, ky)[kx]);
                const Complex expected =
                    spectrum_at(small.values, small.size, small.padded, kx, ky);
                EXPECT_LT(std::abs(found - expected), 1e-4) << kx << ", " << ky;
            }
        }
        small.plane.inverse(small.work);
        std::vector<ComplexF> back(small.values.size());
        small.plane.store(small.work, back.data());
        const float scale = 1.0F / static_cast<float>(small.padded[0] * small.padded[1]);
        for (std::size_t i = 0; i < back.size(); ++i) {
            EXPECT_LT(std::abs(scale * back[i] - small.values[i]), 1e-6F) << i;
        }
    }
}

TEST(PaddedPlane, SpectraStandWithKxAlongRowsAndComeBack) {
    expect_spectra_there_and_back(SmallPlane({8, 12}));
    expect_spectra_there_and_back(SmallPlane({6, 10}));  // no whole fours
}

TEST(PaddedPlane, MultipliesByAnEvenFiltersQuadrant) {
    SmallPlane small;
    const std::size_t qx = small.padded[0] / 2 + 1;
    const std::size_t qy = small.padded[1] / 2 + 1;
    std::vector<ComplexF> quadrant;
    for (std::size_t i = 0; i < qx * qy; ++i) {
        quadrant.emplace_back(static_cast<float>(i), 1.0F - static_cast<float>(i % 3));
    }
    small.plane.load(small.values.data(), small.work);
    small.plane.forward(small.work);
    small.plane.multiply_by_quadrant(quadrant.data(), small.work);
    for (std::size_t ky = 0; ky < small.padded[1]; ++ky) {
        for (std::size_t kx = 0; kx < small.padded[0]; ++kx) {
            const std::size_t i =
                std::min(ky, small.padded[1] - ky) * qx + std::min(kx, small.padded[0] - kx);
            const Complex expected =
                Complex(quadrant[i]) * spectrum_at(small.values, small.size, small.padded, kx, ky);
            const Complex found(small.plane.spectrum_row(small.work, ky)[kx]);
            EXPECT_LT(std::abs(found - expected), 1e-5 * (1.0 + std::abs(expected))) << kx << ky;
        }
    }
}

TEST(PlaneRows, AreTheColumnsOfPlanes) {
    constexpr std::size_t kRows = 11, kPlanes = 21, kColumns = 30, kFirst = 4, kStride = 25;
    std::vector<ComplexF> planes;
    for (std::size_t i = 0; i < kPlanes * kColumns; ++i) planes.emplace_back(static_cast<float>(i));
    const std::vector<ComplexF> before = planes;
    std::vector<ComplexF> rows(kRows * kStride);
    const PlaneRows copies{rows.data(), kStride, kRows, planes.data() + kFirst, kColumns, kPlanes};
    copies.copy_to_rows();
    for (std::size_t row = 0; row < kRows; ++row) {
        for (std::size_t k = 0; k < kPlanes; ++k) {
            EXPECT_EQ(rows[row * kStride + k], before[k * kColumns + kFirst + row]);
        }
    }
    for (ComplexF& value : rows) value += 1.0F;
    copies.copy_to_planes();
    for (std::size_t i = 0; i < planes.size(); ++i) {
        const bool is_copied = i % kColumns >= kFirst && i % kColumns < kFirst + kRows;
        EXPECT_EQ(planes[i], before[i] + (is_copied ? 1.0F : 0.0F)) << i;
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
