// SPDX-License-Identifier: MIT
#include "apps/bench/field/peak_depths.h"

#include <gtest/gtest.h>

#include <cmath>

namespace apps {
namespace {

nlos::Volume volume_with_columns(const std::vector<double>& depths_m, double width_m) {
    nlos::Volume volume;
    volume.axes.x_m = nlos::cell_centers(-0.5, 0.5, depths_m.size());
    volume.axes.y_m = {0.0};
    volume.axes.z_m = nlos::cell_centers(0.0, 1.0, 50);
    for (const double depth_m : depths_m) {
        for (const double z_m : volume.axes.z_m) {
            const double offset = (z_m - depth_m) / width_m;
            volume.values.push_back(static_cast<float>(std::exp(-0.5 * offset * offset)));
        }
    }
    return volume;
}

// The parabola through the logarithms of three values of a Gaussian finds its middle but for
// rounding to floats.
TEST(PeakDepths, LieBetweenVoxels) {
    const std::vector<double> depths_m{0.3012, 0.5, 0.6199};
    const core::DepthMap found = peak_depths(volume_with_columns(depths_m, 0.03));
    for (std::size_t c = 0; c < depths_m.size(); ++c) {
        EXPECT_NEAR(found.depth_m[c], depths_m[c], 1e-6);
    }
}

TEST(PeakDepths, DimColumnsHaveNone) {
    nlos::Volume volume = volume_with_columns({0.3, 0.5}, 0.03);
    for (std::size_t z = 0; z < 50; ++z) volume.values[z] *= 0.19F;
    EXPECT_TRUE(std::isnan(peak_depths(volume).depth_m[0]));
    EXPECT_FALSE(std::isnan(peak_depths(volume).depth_m[1]));
    for (float& value : volume.values) value = 0.0F;
    EXPECT_TRUE(std::isnan(peak_depths(volume).depth_m[1]));
}

}  // namespace
}  // namespace apps
