// SPDX-License-Identifier: MIT
#include "nlos/methods/backprojection.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nlos {
namespace {

using core::Vec3;

struct Case {
    core::Capture capture;
    WallFrame wall;
    VolumeAxes axes;

    MethodInput input(const core::Progress& progress) const {
        return {capture.scan.wall(),
                capture.time_axis,
                capture.transient,
                wall,
                axes,
                {axes.z_m.front(), axes.z_m.back()},
                progress};
    }
};

Case make_case() {
    Case c;
    c.capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({9, 8}, {0.05, 0.05}), {0.0, 0.02, 100});
    c.wall = derive_wall_frame(c.capture.scan.wall());
    c.axes.x_m = cell_centers(c.wall.min_m[0], c.wall.max_m[0], 9);
    c.axes.y_m = cell_centers(c.wall.min_m[1], c.wall.max_m[1], 8);
    c.axes.z_m = cell_centers(0.3, 0.6, 15);
    return c;
}

TEST(FilteredBackprojection, FlatVolumesHaveNoLaplacian) {
    Case c = make_case();
    for (float& value : c.capture.transient.values()) value = 1.0F;
    const core::Progress progress;
    const Volume flat = backproject(c.input(progress), {}, 1);
    const Volume filtered = kFbp.run(c.input(progress), {}, 1);
    for (std::size_t i = 0; i < flat.values.size(); ++i) {
        ASSERT_NEAR(filtered.values[i], 0.0F, 1e-5F * flat.values[i]);
    }
}

TEST(FilteredBackprojection, IsTheLaplacianOfAGaussianOfTheSums) {
    Case c = make_case();
    nlos_test::add_scatterer(c.capture, Vec3(0.0, 0.025, 0.45), 4.0);
    const core::Progress progress;
    const Volume sums = backproject(c.input(progress), {}, 1);
    const Volume filtered = kFbp.run(c.input(progress), {}, 1);
    double expected = 0.0;
    double mean = 0.0;
    double mean_weight = 0.0;
    for (int dx = -2; dx <= 2; ++dx) {
        for (int dy = -2; dy <= 2; ++dy) {
            for (int dz = -2; dz <= 2; ++dz) {
                const double r2 = dx * dx + dy * dy + dz * dz;
                const double value = sums.values[sums.index(static_cast<std::size_t>(4 + dx),
                                                            static_cast<std::size_t>(4 + dy),
                                                            static_cast<std::size_t>(7 + dz))];
                const double weight = (3.0 - r2) * std::exp(-0.5 * r2);
                expected += weight * value;
                mean += value / 125.0;
                mean_weight += weight;
            }
        }
    }
    expected -= mean_weight * mean;
    EXPECT_GT(expected, 0.0);
    EXPECT_NEAR(filtered.values[filtered.index(4, 4, 7)], expected, 1e-4 * expected);
}

}  // namespace
}  // namespace nlos
