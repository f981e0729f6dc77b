// SPDX-License-Identifier: MIT
#include "nlos/methods/light_cone.h"

#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>

namespace nlos {
namespace {

/// The cone of a grid of 9 x 7 points and an axis of 120 bins.
struct ConeCase {
    core::Capture capture;
    WallFrame wall = derive_wall_frame(capture.scan.wall());
    VolumeAxes axes{};
    core::Progress progress{};
    Cone cone = make_cone({capture.scan.wall(),
                           capture.time_axis,
                           capture.transient,
                           wall,
                           axes,
                           {0.4, 0.7},
                           progress},
                          1);

    explicit ConeCase(double pitch_m)
        : capture(nlos_test::confocal_capture(nlos_test::wall_grid({9, 7}, {pitch_m, pitch_m}),
                                              {0.8, 0.02, 120})) {}
};

/// Of all offsets of the padded grid, whether they meet bins or not.
std::size_t latest_shift(const ConeCase& example) {
    const double dx = 0.5 * static_cast<double>(example.cone.px) * example.wall.grid->pitch_m[0];
    const double dy = 0.5 * static_cast<double>(example.cone.py) * example.wall.grid->pitch_m[1];
    return static_cast<std::size_t>((dx * dx + dy * dy) / example.cone.v_width()) + 1;
}

TEST(Cone, PeriodKeepsLateLightFromTheStart) {
    const ConeCase small_wall(0.05);
    const Cone& cone = small_wall.cone;
    EXPECT_GE(cone.length, cone.num_v() + latest_shift(small_wall));
    EXPECT_LT(cone.length, 3 * cone.num_v() / 2);
    EXPECT_EQ(cone.length % 2, 0U);
    // What a large wall's farthest points see later than the axis is no entry of the kernel.
    const ConeCase large_wall(0.4);
    EXPECT_GT(latest_shift(large_wall), large_wall.cone.num_v());
    EXPECT_GE(large_wall.cone.length, 2 * large_wall.cone.num_v());
    EXPECT_LT(large_wall.cone.length, 5 * large_wall.cone.num_v() / 2);
}

TEST(ConeKernel, SpectrumIsTheTransformOfItsEntries) {
    const ConeCase example(0.05);
    const ConeKernel kernel(example.cone, *example.wall.grid);
    constexpr std::size_t kFirst = 3, kCount = 200;  // places turn around many times
    ConeKernel::Spectrum spectrum(kernel, kFirst);
    std::vector<ComplexF> quadrant(kernel.qx() * kernel.qy());
    for (std::size_t k = kFirst; k < kFirst + kCount; ++k) {
        spectrum.next(quadrant.data());
        for (std::size_t i = 0; i < quadrant.size(); ++i) {
            const ConeEntry entry = kernel.entry(i / kernel.qy(), i % kernel.qy());
            const double angle = -2.0 * core::kPi * static_cast<double>(k) /
                                 static_cast<double>(example.cone.length);
            const std::complex<double> expected =
                std::polar(static_cast<double>(entry.here), angle * entry.shift) +
                std::polar(static_cast<double>(entry.next), angle * (entry.shift + 1.0));
            ASSERT_LT(std::abs(std::complex<double>(quadrant[i]) - expected), 1e-6)
                << k << " " << i;
        }
    }
}

}  // namespace
}  // namespace nlos
