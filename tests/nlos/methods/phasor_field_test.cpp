// SPDX-License-Identifier: MIT
#include "nlos/fourier/unit_phasor.h"
#include "nlos/methods/backprojection.h"
#include "nlos/methods/virtual_wave.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

namespace nlos {
namespace {

using core::ScanPattern;
using core::Vec3;

const PhasorSettings kWave{0.2, 4.0};

ReconstructSettings with_wave() {
    ReconstructSettings settings;
    settings.phasor = kWave;
    return settings;
}

core::Capture random_capture(ScanPattern pattern) {
    core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({7, 5}, {0.05, 0.04}), {0.3, 0.01, 150});
    capture.scan.wall().pattern = pattern;
    if (pattern == ScanPattern::Single) {
        capture.scan.wall().illumination = nlos_test::wall_grid({1, 1}, {1.0, 1.0});
        capture.scan.wall().illumination.positions[0] = Vec3(0.13, -0.2, 0.0);
    }
    if (pattern == ScanPattern::Exhaustive) {
        capture.scan.wall().illumination = nlos_test::wall_grid({2, 3}, {0.07, 0.11});
    }
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    capture.scan.wall().laser_position = Vec3(0.1, 0.0, -0.15);
    capture.scan.wall().detector_position = Vec3(-0.05, 0.08, -0.1);
    capture.transient = core::Transient(capture.scan.num_pairs(), capture.time_axis.num_bins);
    std::mt19937_64 generator(test_support::seed_of("random_capture"));
    std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
    for (float& value : capture.transient.values()) value = uniform(generator);
    return capture;
}

/// exp(-t^2 / (2 sigma^2)) exp(2 pi i t / wavelength).
std::complex<double> wave_at(double t) {
    const double sigma = kWave.cycles * *kWave.wavelength_m / 6.0;
    return std::polar(std::exp(-0.5 * t * t / (sigma * sigma)),
                      2.0 * core::kPi * t / *kWave.wavelength_m);
}

/// The sum over pairs and bins that defines the field, in double precision.
double field_magnitude(const core::Capture& capture, const Vec3& p) {
    std::complex<double> sum = 0.0;
    const core::WallScan& scan = capture.scan.wall();
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        const Vec3& l = scan.illumination.positions[scan.illumination_index(pair)];
        const Vec3& s = scan.sensing.positions[scan.sensing_index(pair)];
        const double opl = (l - p).norm() + (p - s).norm() + scan.device_segments_m(pair);
        const auto histogram = capture.transient.histogram(pair);
        for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
            const double center = capture.time_axis.bin_center_m(static_cast<double>(bin));
            sum += static_cast<double>(histogram[bin]) * wave_at(opl - center);
        }
    }
    return std::abs(sum);
}

VolumeAxes axes_of(const WallFrame& wall) {
    VolumeAxes axes;
    axes.x_m = cell_centers(-0.175, 0.175, 7);  // at the sensing points
    axes.y_m = cell_centers(-0.1, 0.1, 5);
    axes.z_m = cell_centers(0.3, 0.6, 33);  // two groups of planes
    axes.world_from_wall = wall.world_from_wall;
    return axes;
}

/// Largest difference of a volume and the defining sum, relative to the volume's maximum; over a
/// quarter of the voxels, some in every column and every plane.
double largest_error(const core::Capture& capture, const Volume& volume) {
    double error = 0.0;
    double largest = 0.0;
    for (std::size_t ix = 0; ix < volume.axes.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < volume.axes.y_m.size(); ++iy) {
            for (std::size_t iz = (ix + iy) % 4; iz < volume.axes.z_m.size(); iz += 4) {
                const Vec3 p = volume.axes.world_from_wall *
                               Vec3(volume.axes.x_m[ix], volume.axes.y_m[iy], volume.axes.z_m[iz]);
                const double expected = field_magnitude(capture, p);
                const double found = volume.values[volume.index(ix, iy, iz)];
                error = std::max(error, std::abs(found - expected));
                largest = std::max(largest, expected);
            }
        }
    }
    return error / largest;
}

double error_of(ScanPattern pattern, const auto& method) {
    const core::Capture capture = random_capture(pattern);
    const WallFrame wall = derive_wall_frame(capture.scan.wall());
    const VolumeAxes axes = axes_of(wall);
    const core::Progress progress;
    return largest_error(capture,
                         method(MethodInput{capture.scan.wall(),
                                            capture.time_axis,
                                            capture.transient,
                                            wall,
                                            axes,
                                            {0.3, 0.6},
                                            progress}));
}

TEST(PhasorField, EqualsItsDefiningSumForEveryScan) {
    // The band of 3 standard deviations leaves out 0.3 % of the wave.
    for (const ScanPattern pattern :
         {ScanPattern::Single, ScanPattern::Confocal, ScanPattern::Exhaustive}) {
        const double error = error_of(
            pattern, [](const MethodInput& input) { return kPhasor.run(input, with_wave(), 1); });
        EXPECT_LT(error, 0.01) << core::enum_name(pattern);
    }
}

TEST(PhasorField, OfFilteredHistogramsIsTheSameWithinInterpolation) {
    for (const ScanPattern pattern :
         {ScanPattern::Single, ScanPattern::Confocal, ScanPattern::Exhaustive}) {
        const double error = error_of(pattern, [](const MethodInput& input) {
            return phasor_backprojection(input, with_wave(), 1);
        });
        EXPECT_LT(error, 0.04) << core::enum_name(pattern);
    }
}

TEST(PhasorField, ServesListsOfPoints) {
    core::Capture capture = random_capture(ScanPattern::Single);
    capture.scan.wall().sensing.grid.reset();
    const WallFrame wall = derive_wall_frame(capture.scan.wall());
    VolumeAxes axes = axes_of(wall);
    const core::Progress progress;
    const Volume volume = kPhasor.run({capture.scan.wall(),
                                       capture.time_axis,
                                       capture.transient,
                                       wall,
                                       axes,
                                       {0.3, 0.6},
                                       progress},
                                      with_wave(),
                                      1);
    EXPECT_LT(largest_error(capture, volume), 0.04);
}

TEST(VirtualWave, SumOfItsFrequenciesIsTheWave) {
    const VirtualWave wave = make_virtual_wave(kWave, 1.0);
    for (double t = -0.9; t <= 0.9; t += 0.03) {
        std::complex<double> sum = 0.0;
        for (std::size_t i = 0; i < wave.size(); ++i) {
            sum += std::polar(wave.amplitudes[i], 2.0 * core::kPi * wave.frequency(i) * t);
        }
        EXPECT_LT(std::abs(sum - wave_at(t)), 0.01) << t;
    }
}

TEST(VirtualWave, WavelengthFollowsThePitch) {
    const core::Capture single = random_capture(ScanPattern::Single);
    const core::Capture confocal = random_capture(ScanPattern::Confocal);
    const auto wavelength = [](const core::Capture& capture, double bin_width_m) {
        return default_wavelength_m(
            capture.scan.wall(), derive_wall_frame(capture.scan.wall()), {0.0, bin_width_m, 100});
    };
    EXPECT_NEAR(wavelength(single, 0.01), 4 * 0.05, 1e-9);
    EXPECT_NEAR(wavelength(confocal, 0.01), 6 * 0.05, 1e-9);
    EXPECT_NEAR(wavelength(single, 0.1), 0.4, 1e-9);
}

TEST(UnitPhasor, IsTheComplexExponential) {
    for (double turns = -3.0; turns < 500.0; turns += 0.0137) {
        const UnitPhasor p = unit_phasor(turns);
        const double angle = 2.0 * core::kPi * turns;
        ASSERT_NEAR(p.re, std::cos(angle), 1e-6) << turns;
        ASSERT_NEAR(p.im, std::sin(angle), 1e-6) << turns;
    }
}

}  // namespace
}  // namespace nlos
