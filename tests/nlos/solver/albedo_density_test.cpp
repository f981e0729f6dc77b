// SPDX-License-Identifier: MIT
#include "nlos/solver/albedo_density.h"

#include "nlos/reconstruct.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nlos {
namespace {

using core::Vec3;

constexpr double kPointPitch_m = 0.01;
constexpr double kPlateAlbedo = 0.3;

/// A plate of 0.36 m x 0.36 m, as points of its albedo, 0.5 m before the middle of a wall.
core::Capture capture_of_plate(std::size_t columns) {
    const double pitch_m = 0.8 / static_cast<double>(columns);
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({columns, columns}, {pitch_m, pitch_m}), {0.8, 0.016, 64});
    for (int ix = -18; ix < 18; ++ix) {
        for (int iy = -18; iy < 18; ++iy) {
            const Vec3 position((ix + 0.5) * kPointPitch_m, (iy + 0.5) * kPointPitch_m, 0.5);
            nlos_test::add_scatterer(capture, position, 4.0);
        }
    }
    const double light = kPlateAlbedo * std::pow(kPointPitch_m, 2) / std::pow(core::kPi, 3);
    for (float& value : capture.transient.values()) value *= static_cast<float>(light);
    return capture;
}

/// The mean over the plate's inner columns of what the solver's volume adds up to along z.
double albedo_of_plate(const core::Capture& capture, int columns) {
    ReconstructSettings settings;
    settings.method = Method::Solver;
    settings.volume.voxels = {columns, columns, 64};
    const Volume volume = reconstruct(capture, settings, {}).volume;
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t ix = 0; ix < volume.axes.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < volume.axes.y_m.size(); ++iy) {
            if (std::hypot(volume.axes.x_m[ix], volume.axes.y_m[iy]) > 0.12) continue;
            count += 1.0;
            for (std::size_t iz = 0; iz < volume.axes.z_m.size(); ++iz) {
                sum += volume.axes.z_step_m() *
                       static_cast<double>(volume.values[volume.index(ix, iy, iz)]);
            }
        }
    }
    return sum / count;
}

TEST(AlbedoDensity, EveryOperatorFindsTheAlbedoInVoxelsOfAnySize) {
    constexpr double kTolerance = 0.05;
    core::Capture capture = capture_of_plate(20);
    // On a grid the solver's cones find this plate a quarter brighter (1.28).
    EXPECT_NEAR(albedo_of_plate(capture, 20) / kPlateAlbedo, 1.0, 0.35);
    // All points but one fill no grid.
    for (core::WallPoints* points :
         {&capture.scan.wall().sensing, &capture.scan.wall().illumination}) {
        points->positions.pop_back();
        points->normals.pop_back();
        points->grid.reset();
    }
    core::Transient fewer(capture.scan.num_pairs(), capture.time_axis.num_bins);
    std::copy_n(capture.transient.values().begin(), fewer.values().size(), fewer.values().begin());
    capture.transient = fewer;
    for (const int columns : {20, 27}) {
        EXPECT_NEAR(albedo_of_plate(capture, columns) / kPlateAlbedo, 1.0, kTolerance) << columns;
    }
}

}  // namespace
}  // namespace nlos
