// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/depth_sigma.h"

#include "renderer/core/types.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace nlos {
namespace {

constexpr double kVoxelStep = 0.01;  // from voxel to voxel [m]
constexpr double kPeakWidth = 1.5;   // of a peak [voxels]
constexpr double kFlatVoxel = 9.3;   // of the flat surface [voxels]
constexpr std::size_t kCenterColumn = 4 * 9 + 4;

/// 9 x 9 columns of 20 voxels with a Gaussian each.
Volume gaussian_columns(double position) {
    Volume volume;
    volume.axes.x_m = cell_centers(-0.09, 0.09, 9);
    volume.axes.y_m = volume.axes.x_m;
    volume.axes.z_m = cell_centers(0.4, 0.4 + 20.0 * kVoxelStep, 20);
    for (std::size_t i = 0; i < 81 * 20; ++i) {
        const double steps = (static_cast<double>(i % 20) - position) / kPeakWidth;
        volume.values.push_back(static_cast<float>(std::exp(-0.5 * steps * steps)));
    }
    return volume;
}

/// The flat surface of these columns, as find_surface() gives it.
struct FlatSurface {
    Volume volume = gaussian_columns(kFlatVoxel);
    std::vector<ColumnPeak> peaks;
    Surface surface;

    explicit FlatSurface(double probability) {
        surface.depth = core::DepthMap(volume.axes.x_m, volume.axes.y_m);
        for (std::size_t i = 0; i < 81; ++i) {
            peaks.push_back(find_peak({volume.values.data() + i * 20, 20}, 9));
            surface.probability.push_back(probability);
            surface.depth.depth_m[i] = volume.axes.z_m[0] + kVoxelStep * peaks.back().position;
        }
    }
    std::vector<double> sigmas(const Volume& again, const VolumeErrors& errors) const {
        return depth_sigmas(volume, peaks, surface, again, errors);
    }
};

VolumeErrors fractions(double model, double noise, double doubt, double near_by) {
    return {VolumeScale::Amplitude, model, noise, doubt, near_by, {}};
}

TEST(DepthSigma, WithoutNoiseIsAFractionOfThePeaksWidth) {
    const FlatSurface sure(1.0);
    for (const double sigma : sure.sigmas(sure.volume, fractions(0.1, 0.5, 7.0, 0.4))) {
        EXPECT_NEAR(sigma, 0.1 * kPeakWidth * kVoxelStep, 1e-6);  // floats
    }
}

TEST(DepthSigma, GrowsWithTheOddsAgainstASurface) {
    const FlatSurface doubtful(0.8);  // odds of a quarter
    for (const double sigma : doubtful.sigmas(doubtful.volume, fractions(0.1, 0.5, 7.0, 0.4))) {
        EXPECT_NEAR(sigma, 0.1 * kPeakWidth * kVoxelStep * std::hypot(1.0, 7.0 / 4.0), 1e-6);
    }
}

TEST(DepthSigma, OfNoiseIsThatOfHowFarPeaksMove) {
    const FlatSurface sure(1.0);
    const Volume half = gaussian_columns(kFlatVoxel + 0.2);  // the other half is at - 0.2
    for (const double sigma : sure.sigmas(half, fractions(0.0, 0.5, 0.0, 0.0))) {
        const double mean_size = std::sqrt(2.0 / core::kPi);  // of a deviation of 1
        EXPECT_NEAR(sigma, 0.5 * 0.2 / mean_size * kVoxelStep, 0.03 * 0.1 * kVoxelStep);
    }
}

TEST(DepthSigma, OfAColumnOffItsNeighboursPlaneSaysSo) {
    FlatSurface rough(1.0);
    rough.surface.depth.depth_m[kCenterColumn] += 5.0 * kVoxelStep;
    const std::vector<double> own = rough.sigmas(rough.volume, fractions(0.0, 0.0, 0.0, 0.0));
    EXPECT_NEAR(own[kCenterColumn], 0.8 * 5.0 * kVoxelStep, 1e-6);
    EXPECT_LT(own[kCenterColumn + 1], 0.5 * kVoxelStep);  // one of 24 that its plane goes through
    const std::vector<double> with_near = rough.sigmas(rough.volume, fractions(0.0, 0.0, 0.0, 1.0));
    EXPECT_GT(with_near[kCenterColumn + 1], own[kCenterColumn + 1] + 0.1 * kVoxelStep);
}

TEST(DepthSigma, OfBackgroundIsNone) {
    FlatSurface holed(1.0);
    holed.surface.depth.depth_m[kCenterColumn] = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> sigmas = holed.sigmas(holed.volume, fractions(0.1, 0.5, 7.0, 0.4));
    for (std::size_t i = 0; i < sigmas.size(); ++i) {
        EXPECT_EQ(std::isnan(sigmas[i]), i == kCenterColumn) << i;
    }
}

}  // namespace
}  // namespace nlos
