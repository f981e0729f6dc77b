// SPDX-License-Identifier: MIT
#include "nlos/methods/methods.h"
#include "nlos/reconstruction/surface.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Vec3;
using nlos_test::confocal_capture;
using nlos_test::wall_grid;

Volume transform(const core::Capture& capture,
                 std::array<double, 2> z_range_m,
                 std::size_t num_z,
                 Falloff falloff = Falloff::Diffuse) {
    const WallFrame wall = derive_wall_frame(capture.scan.wall());
    VolumeAxes axes;
    axes.x_m = cell_centers(wall.min_m[0], wall.max_m[0], wall.grid->size[0]);
    axes.y_m = cell_centers(wall.min_m[1], wall.max_m[1], wall.grid->size[1]);
    axes.z_m = cell_centers(z_range_m[0], z_range_m[1], num_z);
    axes.world_from_wall = wall.world_from_wall;
    const core::Progress progress;
    ReconstructSettings settings;
    settings.falloff = falloff;
    settings.snr = 10.0;
    return kLct.run({capture.scan.wall(),
                     capture.time_axis,
                     capture.transient,
                     wall,
                     axes,
                     z_range_m,
                     progress},
                    settings,
                    1);
}

Vec3 brightest_voxel(const Volume& volume) {
    const auto i = static_cast<std::size_t>(
        std::max_element(volume.values.begin(), volume.values.end()) - volume.values.begin());
    const std::size_t nz = volume.axes.z_m.size();
    const std::size_t ny = volume.axes.y_m.size();
    return {volume.axes.x_m[i / (ny * nz)], volume.axes.y_m[i / nz % ny], volume.axes.z_m[i % nz]};
}

TEST(LightConeTransform, FindsAPointOnOblongGridsWithUnequalPitch) {
    const auto points = wall_grid({12, 20}, {0.06, 0.03});
    const Vec3 scatterer(0.09, -0.105, 0.52);
    for (const double start : {0.0, 0.6, -0.01}) {
        for (const Falloff falloff : {Falloff::Diffuse, Falloff::Retro}) {
            core::Capture capture = confocal_capture(points, {start, 0.016, 128});
            nlos_test::add_scatterer(capture, scatterer, falloff == Falloff::Diffuse ? 4.0 : 2.0);
            const Vec3 found = brightest_voxel(transform(capture, {0.3, 0.9}, 75, falloff));
            EXPECT_NEAR(found.x(), scatterer.x(), 1e-9);
            EXPECT_NEAR(found.y(), scatterer.y(), 1e-9);
            EXPECT_NEAR(found.z(), scatterer.z(), 0.0081);
        }
    }
}

TEST(LightConeTransform, TakesDeviceSegmentsOffEveryPoint) {
    core::Capture capture = confocal_capture(wall_grid({16, 16}, {0.05, 0.05}), {0.9, 0.016, 160});
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    capture.scan.wall().laser_position = Vec3(0.5, 0.3, -0.6);
    capture.scan.wall().detector_position = Vec3(-0.4, 0.1, -0.7);
    const Vec3 scatterer(-0.125, 0.075, 0.6);
    nlos_test::add_scatterer(capture, scatterer, 4.0);
    const Vec3 found = brightest_voxel(transform(capture, {0.3, 0.9}, 75));
    EXPECT_LT((found - scatterer).norm(), 0.0081);
}

TEST(LightConeTransform, PlacesAPlaneWithinAQuarterOfABin) {
    core::Capture capture = confocal_capture(wall_grid({24, 24}, {0.04, 0.04}), {0.0, 0.016, 128});
    for (int ix = -20; ix <= 20; ++ix) {
        for (int iy = -20; iy <= 20; ++iy) {
            nlos_test::add_scatterer(capture, Vec3(0.02 * ix, 0.02 * iy, 0.6), 4.0);
        }
    }
    const core::DepthMap depth =
        find_surface(transform(capture, {0.3, 0.9}, 75), nullptr, {}, 0.2).depth;
    double sum = 0.0;
    for (std::size_t ix = 8; ix < 16; ++ix) {
        for (std::size_t iy = 8; iy < 16; ++iy) {
            sum += depth.depth_m[depth.index(ix, iy)] / 64.0;
        }
    }
    EXPECT_NEAR(sum, 0.6, 0.002);
}

// Up to where bins and voxels happen to lie.
TEST(LightConeTransform, EqualPointsAreEquallyBrightAtAnyDepth) {
    const auto brightness = [](double depth) {
        core::Capture capture =
            confocal_capture(wall_grid({24, 24}, {0.04, 0.04}), {0.0, 0.016, 160});
        nlos_test::add_scatterer(capture, Vec3(0.02, 0.02, depth), 4.0);
        const Volume volume = transform(capture, {0.2, 1.1}, 225);
        return *std::max_element(volume.values.begin(), volume.values.end());
    };
    EXPECT_NEAR(brightness(0.8) / brightness(0.4), 1.0, 0.2);
}

TEST(LightConeTransform, OfDarknessIsDark) {
    const core::Capture capture =
        confocal_capture(wall_grid({5, 7}, {0.05, 0.05}), {0.0, 0.02, 40});
    for (const float value : transform(capture, {0.0, 0.4}, 40).values) EXPECT_EQ(value, 0.0F);
}

TEST(LightConeTransform, IsFiniteAndNotNegativeEverywhere) {
    core::Capture capture = confocal_capture(wall_grid({7, 5}, {0.05, 0.05}), {-0.02, 0.02, 50});
    for (float& value : capture.transient.values()) value = 1.0F;
    for (const float value : transform(capture, {0.0, 3.0}, 100).values) {
        EXPECT_TRUE(std::isfinite(value));
        EXPECT_GE(value, 0.0F);
    }
}

TEST(LightConeTransform, HasTheSameBitsForAnyNumberOfThreads) {
    core::Capture capture = confocal_capture(wall_grid({10, 9}, {0.05, 0.05}), {0.0, 0.02, 64});
    nlos_test::add_scatterer(capture, Vec3(0.1, 0.0, 0.4), 4.0);
    const auto values = [&](int threads) {
        const core::ThreadLimit limit(threads);
        return transform(capture, {0.1, 0.6}, 50).values;
    };
    EXPECT_EQ(values(1), values(7));
}

}  // namespace
}  // namespace nlos
