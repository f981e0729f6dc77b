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

Volume migrate(const core::Capture& capture,
               std::array<double, 2> z_range_m,
               std::size_t num_z,
               Falloff falloff) {
    const WallFrame wall = derive_wall_frame(capture.scan.wall());
    VolumeAxes axes;
    axes.x_m = cell_centers(wall.min_m[0], wall.max_m[0], wall.grid->size[0]);
    axes.y_m = cell_centers(wall.min_m[1], wall.max_m[1], wall.grid->size[1]);
    axes.z_m = cell_centers(z_range_m[0], z_range_m[1], num_z);
    axes.world_from_wall = wall.world_from_wall;
    const core::Progress progress;
    ReconstructSettings settings;
    settings.falloff = falloff;
    return kFk.run({capture.scan.wall(),
                    capture.time_axis,
                    capture.transient,
                    wall,
                    axes,
                    z_range_m,
                    progress},
                   settings,
                   1);
}

TEST(FkMigration, FindsAPointOnOblongGridsWithUnequalPitch) {
    const auto points = nlos_test::wall_grid({14, 20}, {0.06, 0.03});
    const Vec3 scatterer(0.09, -0.105, 0.52);
    for (const Falloff falloff : {Falloff::Diffuse, Falloff::Retro}) {
        core::Capture capture = nlos_test::confocal_capture(points, {0.3, 0.016, 100});
        nlos_test::add_scatterer(capture, scatterer, falloff == Falloff::Diffuse ? 4.0 : 2.0);
        const Volume volume = migrate(capture, {0.3, 0.9}, 75, falloff);
        EXPECT_LT((nlos_test::brightest_point(volume) - scatterer).norm(), 0.0016);
    }
}

TEST(FkMigration, CoarseVoxelsHoldTheMeanOfTheFineOnesTheyCover) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({12, 12}, {0.04, 0.04}), {0.0, 0.016, 128});
    nlos_test::add_scatterer(capture, Vec3(0.02, 0.06, 0.5), 4.0);
    const Volume fine = migrate(capture, {0.4, 0.592}, 24, Falloff::Diffuse);
    const Volume coarse = migrate(capture, {0.4, 0.592}, 8, Falloff::Diffuse);
    const float brightest = *std::max_element(coarse.values.begin(), coarse.values.end());
    for (std::size_t i = 0; i < coarse.values.size(); ++i) {
        const float* covered = &fine.values[3 * i];
        const float mean = (covered[0] + covered[1] + covered[2]) / 3.0F;
        ASSERT_LE(coarse.values[i], mean + 1e-3F * brightest);
        if (*std::min_element(covered, covered + 3) == 0.0F) continue;  // it may have been negative
        ASSERT_NEAR(coarse.values[i], mean, 1e-3F * brightest);
    }
}

TEST(FkMigration, APlateIsAtItsDepth) {
    // All its cosines are z / r, so that its light falls with r^8. The peaks of a magnitude lie
    // behind it.
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({32, 32}, {0.03, 0.03}), {0.0, 0.016, 160});
    const double depth_m = 0.703;
    for (int ix = -5; ix <= 5; ++ix) {
        for (int iy = -20; iy <= 20; ++iy) {
            nlos_test::add_scatterer(capture, Vec3(0.01 * ix, 0.01 * iy, depth_m), 8.0);
        }
    }
    const Volume volume = migrate(capture, {0.4, 1.0}, 75, Falloff::Diffuse);
    const core::DepthMap depth = find_surface(volume, nullptr, {}, 0.5).depth;
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t ix = 15; ix < 17; ++ix) {
        for (std::size_t iy = 10; iy < 22; ++iy) {
            ASSERT_TRUE(depth.is_foreground(depth.index(ix, iy)));
            sum += depth.depth_m[depth.index(ix, iy)] - depth_m;
            count += 1.0;
        }
    }
    EXPECT_LT(std::abs(sum / count), 0.03 * 0.008);  // of a voxel
}

TEST(FkMigration, EqualPointsAreEquallyBrightAtAnyDepth) {
    // The published way of reading between samples of the spectrum dims what is far.
    const auto brightness = [](double depth) {
        core::Capture capture = nlos_test::confocal_capture(
            nlos_test::wall_grid({24, 24}, {0.04, 0.04}), {0.0, 0.016, 160});
        nlos_test::add_scatterer(capture, Vec3(0.02, 0.02, depth), 4.0);
        const Volume volume = migrate(capture, {0.2, 1.1}, 225, Falloff::Diffuse);
        return *std::max_element(volume.values.begin(), volume.values.end());
    };
    // The solid angle of the wall is all that should matter: for 1/r the field falls with it.
    const double near = brightness(0.3);
    const double far = brightness(1.0);
    EXPECT_LT(far, near);
    EXPECT_GT(far, near / 40.0);
}

}  // namespace
}  // namespace nlos
