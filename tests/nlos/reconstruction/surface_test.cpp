// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface.h"

#include <gtest/gtest.h>

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

TEST(Surface, FindsDepthsBetweenVoxels) {
    const Volume volume = sloped_plane(0.3);
    const core::DepthMap depth = extract_depth_map(volume, 0.2);
    for (std::size_t ix = 0; ix < 10; ++ix) {
        EXPECT_TRUE(std::isnan(depth.depth_m[depth.index(ix, 0)]));
        for (std::size_t iy = 1; iy < 8; ++iy) {
            EXPECT_NEAR(depth.depth_m[depth.index(ix, iy)], 0.5 + 0.3 * volume.axes.x_m[ix], 1e-5);
        }
    }
}

TEST(Surface, FindsDepthsBetweenVoxelsBesideDarkness) {
    Volume volume = sloped_plane(0.0);
    for (std::size_t column = 0; column < 80; ++column) {
        std::fill_n(volume.values.begin() + static_cast<std::ptrdiff_t>(20 * column), 20, 0.0F);
        volume.values[20 * column + 7] = 0.5F;
        volume.values[20 * column + 8] = 1.0F;
    }
    // The parabola through 0.5, 1 and 0.
    for (const double z : extract_depth_map(volume, 0.2).depth_m) {
        EXPECT_NEAR(z, volume.axes.z_m[8] - 0.01 / 6.0, 1e-9);
    }
}

TEST(Surface, PointsLieInTheWorldWithNormalsTowardsTheWall) {
    const core::PointCloud points = surface_points(extract_depth_map(sloped_plane(0.3), 0.2));
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
    EXPECT_TRUE(surface_points(extract_depth_map(volume, 0.2)).positions.empty());
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
