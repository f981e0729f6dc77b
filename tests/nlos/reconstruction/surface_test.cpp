// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface.h"

#include "renderer/core/random.h"
#include "renderer/core/types.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

/// A plane z = 0.5 + slope x, as a Gaussian in z in every column but the first row, which is dark.
Volume sloped_plane(double slope) {
    Volume volume;
    volume.axes.x_m = cell_centers(-0.1, 0.1, 10);
    volume.axes.y_m = cell_centers(-0.1, 0.1, 8);
    volume.axes.z_m = cell_centers(0.4, 0.6, 20);
    volume.axes.world_from_wall.translation() = core::Vec3(1.0, 2.0, 3.0);
    for (std::size_t ix = 0; ix < 10; ++ix) {
        for (std::size_t iy = 0; iy < 8; ++iy) {
            for (const double z : volume.axes.z_m) {
                const double steps = (z - 0.5 - slope * volume.axes.x_m[ix]) / 0.01;
                const double value = iy == 0 ? 0.1 : std::exp(-0.5 * steps * steps);
                volume.values.push_back(static_cast<float>(value));
            }
        }
    }
    return volume;
}

core::DepthMap depth_of(const Volume& volume) {
    return find_surface(volume, nullptr, {}, 0.5).depth;
}

double normal_deviate(core::Rng& rng) {
    return std::sqrt(-2.0 * std::log(1.0 - rng.uniform())) *
           std::cos(2.0 * core::kPi * rng.uniform());
}

/// 40 x 40 columns of 30 voxels. Noise grows with depth to the power of 4 and negative values are
/// cut off, as by light_cone_transform; the first 10 rows of columns hold a plane at voxel 10.3.
struct NoisyVolumes {
    Volume volume;
    Volume again;

    explicit NoisyVolumes(double brightness) {
        volume.axes.x_m = cell_centers(-0.5, 0.5, 40);
        volume.axes.y_m = volume.axes.x_m;
        volume.axes.z_m = cell_centers(0.0, 1.0, 30);
        core::Rng rng(1, 2, 3);
        for (std::size_t i = 0; i < 1600 * 30; ++i) {
            const double z = static_cast<double>(i % 30);
            const double steps = (z - 10.3) / 1.5;
            const double plane = i / 30 < 400 ? brightness * std::exp(-0.5 * steps * steps) : 0.0;
            const double sigma = std::pow((z + 1.0) / 11.3, 4);
            const double value = plane + sigma * normal_deviate(rng);
            volume.values.push_back(static_cast<float>(std::max(0.0, value)));
            again.values.push_back(
                static_cast<float>(std::max(0.0, value + sigma * normal_deviate(rng))));
        }
        again.axes = volume.axes;
    }
    double true_depth_m() const { return (10.3 + 0.5) / 30.0; }
};

TEST(Surface, FarNoiseThatFalloffRaisedHidesNoSurface) {
    const NoisyVolumes noisy(15.0);  // the farthest noise has a deviation of 50
    const Surface surface = find_surface(noisy.volume, &noisy.again, {}, 0.5);
    int num_wrong = 0;
    for (std::size_t i = 0; i < 1600; ++i) {
        if (i < 400) {
            EXPECT_NEAR(surface.depth.depth_m[i], noisy.true_depth_m(), 0.03) << i;
        } else {
            num_wrong += surface.depth.is_foreground(i) ? 1 : 0;
        }
    }
    EXPECT_LE(num_wrong, 12);  // 1 %
}

TEST(Surface, OfNoiseAloneIsHardlyAny) {
    const NoisyVolumes noisy(0.0);
    const Surface surface = find_surface(noisy.volume, &noisy.again, {}, 0.5);
    EXPECT_LE(surface_points(surface.depth).positions.size(), 16U);  // 1 %
}

TEST(Surface, ReportedDeviationsOfDepthAreThoseOfTheErrors) {
    const NoisyVolumes noisy(25.0);
    const Surface surface = find_surface(noisy.volume, &noisy.again, {}, 0.5);
    double squares = 0.0;
    for (std::size_t i = 0; i < 400; ++i) {
        const double error = surface.depth.depth_m[i] - noisy.true_depth_m();
        squares += std::pow(error / surface.depth_sigma_m[i], 2) / 400.0;
    }
    EXPECT_GT(squares, 0.6);
    EXPECT_LT(squares, 1.4);
}

// The right half of the columns holds the left one's light, spread over five voxels.
TEST(Surface, OfSteepPartsIsAsSureAsTheLightThatTheyGather) {
    Volume volume;
    volume.axes.x_m = cell_centers(-0.2, 0.2, 10);
    volume.axes.y_m = volume.axes.x_m;
    volume.axes.z_m = cell_centers(0.4, 0.6, 10);  // half the distance of columns
    volume.values.resize(1000);
    for (std::size_t column = 0; column < 100; ++column) {
        for (std::size_t iz = 3; iz < 8; ++iz) {
            float& value = volume.values[10 * column + iz];
            if (column < 50) {
                value = iz == 5 ? 1.0F : 0.0F;
            } else {
                value = iz == 5 ? 0.24F : 0.19F;
            }
        }
    }
    VolumeErrors errors;
    errors.plateau = {0.0, 0.4};
    const auto num_surface = [&] {
        return surface_points(find_surface(volume, nullptr, errors, 0.5).depth).positions.size();
    };
    EXPECT_EQ(num_surface(), 50U);
    errors.steepest = 2.0;
    EXPECT_EQ(num_surface(), 100U);
}

// A dim surface before a bright one, which other wall points see past it: the depth is that of the
// dim one, unless it is too dim, one peak with the bright one, dimmer than any other, or noise.
TEST(Surface, OfTwoInAColumnTheFirstHasTheDepth) {
    Volume volume;
    volume.axes.x_m = cell_centers(-0.2, 0.2, 4);
    volume.axes.y_m = volume.axes.x_m;
    volume.axes.z_m = cell_centers(0.0, 1.0, 20);
    const std::vector<float> apart{0, 0, 0.25F, 0.5F, 0.25F, 0, 0, 0, 0, 0.5F, 1, 0.5F};
    const std::vector<float> one{0, 0, 0.25F, 0.5F, 0.4F, 0.3F, 0.3F, 0.3F, 0.4F, 0.5F, 1, 0.5F};
    // Half of the columns hold a surface of this brightness alone.
    const auto fill = [&](std::vector<float> column, float others) {
        column.resize(20);
        volume.values.clear();
        for (int i = 0; i < 8; ++i) {
            volume.values.insert(volume.values.end(), column.begin(), column.end());
        }
        volume.values.resize(320);
        for (std::size_t i = 8; i < 16; ++i) volume.values[20 * i + 10] = others;
    };
    const auto depth_with = [&](double front, const Volume* again) {
        VolumeErrors errors;
        errors.front = front;
        return find_surface(volume, again, errors, 0.5).depth.depth_m[1];
    };
    fill(apart, 0.45F);
    EXPECT_NEAR(depth_with(0.4, nullptr), 0.175, 1e-6);
    EXPECT_NEAR(depth_with(0.6, nullptr), 0.525, 1e-6);
    EXPECT_NEAR(depth_with(0.0, nullptr), 0.525, 1e-6);
    Volume again = volume;
    for (float& value : again.values) value += value > 0.0F ? 1e-4F : 0.0F;
    EXPECT_NEAR(depth_with(0.4, &again), 0.175, 1e-6);
    for (std::size_t i = 0; i < again.values.size(); ++i) {
        if (i % 20 < 8) again.values[i] += 3.0F;  // measured again: there is noise in front
    }
    EXPECT_NEAR(depth_with(0.4, &again), 0.525, 1e-6);
    fill(apart, 0.8F);
    EXPECT_NEAR(depth_with(0.4, nullptr), 0.525, 1e-6);
    fill(one, 0.45F);
    EXPECT_NEAR(depth_with(0.4, nullptr), 0.525, 1e-6);
}

TEST(Surface, DeviationsOfDepthAreNotInvented) {
    const Surface surface = find_surface(sloped_plane(0.3), nullptr, {}, 0.5);
    EXPECT_TRUE(surface.depth_sigma_m.empty());
    EXPECT_EQ(surface.probability.size(), 80U);
}

TEST(Surface, FindsDepthsBetweenVoxels) {
    const Volume volume = sloped_plane(0.3);
    const core::DepthMap depth = depth_of(volume);
    for (std::size_t ix = 0; ix < 10; ++ix) {
        EXPECT_TRUE(std::isnan(depth.depth_m[depth.index(ix, 0)]));
        for (std::size_t iy = 1; iy < 8; ++iy) {
            EXPECT_NEAR(depth.depth_m[depth.index(ix, iy)], 0.5 + 0.3 * volume.axes.x_m[ix], 1e-5);
        }
    }
}

TEST(Surface, PointsLieInTheWorldWithNormalsTowardsTheWall) {
    const core::PointCloud points = surface_points(depth_of(sloped_plane(0.3)));
    ASSERT_EQ(points.positions.size(), 70U);
    const core::Vec3 expected = core::Vec3(0.3, 0.0, -1.0).normalized();
    for (std::size_t i = 0; i < points.positions.size(); ++i) {
        EXPECT_LT((points.normals[i] - expected).norm(), 1e-3);
        const core::Vec3 local = points.positions[i] - core::Vec3(1.0, 2.0, 3.0);
        EXPECT_NEAR(local.z(), 0.5 + 0.3 * local.x(), 1e-5);
    }
}

TEST(Surface, AnEmptyVolumeHasNoForeground) {
    Volume volume = sloped_plane(0.0);
    volume.values.assign(volume.values.size(), 0.0F);
    EXPECT_TRUE(surface_points(depth_of(volume)).positions.empty());
}

TEST(Volume, MaxProjectionIsTheBrightestValueOfEachColumn) {
    Volume volume;
    volume.axes.x_m = {0.0};
    volume.axes.y_m = {0.0, 1.0};
    volume.axes.z_m = {0.0, 1.0, 2.0};
    volume.values = {1.0F, 4.0F, 2.0F, -3.0F, -1.0F, -2.0F};
    EXPECT_EQ(max_projection(volume), (std::vector<float>{4.0F, -1.0F}));
}

}  // namespace
}  // namespace nlos
