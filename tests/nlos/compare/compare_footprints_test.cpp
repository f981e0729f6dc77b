// SPDX-License-Identifier: MIT
// Scores against truths that are more than one depth per column.
#include "nlos/compare/compare.h"
#include "tests/support/example_volume.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace nlos {
namespace {

using test_support::column_volume;
using test_support::kBackground;

/// A truth of two samples per column: a step at the middle of the column, or nothing (NaN).
core::TrueSurface halves_of(const Reconstruction& result,
                            const std::vector<std::array<double, 2>>& depth_m) {
    core::DepthMap view(core::parts_of_cells(result.volume.axes.x_m, 2),
                        core::parts_of_cells(result.volume.axes.y_m, 2));
    for (std::size_t ix = 0; ix < view.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < 2; ++iy) {
            view.depth_m[view.index(ix, iy)] = depth_m[ix / 2][ix % 2];
        }
    }
    return {{view}, 2};
}

TEST(Compare, EitherSideOfAnEdgeInAColumnIsRight) {
    // Columns of 0.1 m: an edge from 0.7 to 0.9 m in the first, half covered the second.
    const double none = kBackground;
    for (const double found_m : {0.701, 0.899}) {
        const Reconstruction result = column_volume({1.0F, 1.0F}, {found_m, 0.7});
        const Metrics metrics =
            compare_to_truth(result, halves_of(result, {{{0.7, 0.9}, {0.7, none}}}));
        EXPECT_NEAR(metrics.depth_mae_m.value(), 0.5e-3, 1e-12);
        EXPECT_DOUBLE_EQ(metrics.depth_coverage.value(), 1.0);
        EXPECT_DOUBLE_EQ(metrics.mask_iou_stated.value(), 1.0);
    }
}

TEST(Compare, WhatIsMissedCountsByItsArea) {
    const double none = kBackground;
    const Reconstruction result = column_volume({1.0F, 0.1F, 0.1F}, {0.7, none, none});
    const Metrics metrics =
        compare_to_truth(result, halves_of(result, {{{0.7, 0.7}, {0.7, none}, {none, none}}}));
    EXPECT_DOUBLE_EQ(metrics.depth_coverage.value(), 1.0 / 1.5);
    EXPECT_DOUBLE_EQ(metrics.mask_iou_stated.value(), 1.0 / 1.5);
    EXPECT_DOUBLE_EQ(metrics.mask_iou.value(), 1.0 / 1.5);
    EXPECT_DOUBLE_EQ(metrics.accuracy.value(), 1.0);
}

TEST(Compare, FScoresAtFixedDistancesDoNotDependOnTheGrid) {
    // A plane that is found 8 mm too far, on grids of 3 and 12 columns per 0.3 m.
    for (const std::size_t columns : {3U, 12U}) {
        Reconstruction result;
        VolumeAxes& axes = result.volume.axes;
        const double width_m = 0.3 / static_cast<double>(columns);
        for (std::size_t i = 0; i < columns; ++i) {
            axes.x_m.push_back(width_m * (static_cast<double>(i) + 0.5));
        }
        axes.y_m = axes.x_m;
        axes.z_m = {0.7, 0.8};
        result.volume.values.assign(columns * columns * 2, 1.0F);
        result.depth = core::DepthMap(axes.x_m, axes.y_m);
        result.depth.depth_m.assign(columns * columns, 0.708);
        result.resolution_m = 0.005;
        const std::size_t per_side = 24 / columns;
        core::DepthMap view(core::parts_of_cells(axes.x_m, per_side),
                            core::parts_of_cells(axes.y_m, per_side));
        view.depth_m.assign(view.depth_m.size(), 0.7);
        const Metrics metrics = compare_to_truth(result, core::TrueSurface({view}, per_side));
        EXPECT_DOUBLE_EQ(metrics.fscore_10mm.value(), 1.0);
        EXPECT_DOUBLE_EQ(metrics.fscore_resolution.value(), 0.0);
        EXPECT_DOUBLE_EQ(metrics.resolution_m.value(), 0.005);
        EXPECT_NEAR(metrics.chamfer_m.value(), 0.008, 1e-12);
        EXPECT_NEAR(metrics.accuracy_m.value(), 0.008, 1e-12);
    }
}

TEST(Compare, ATruthOfThinWiresIsSaidToChangeWithItsResolution) {
    std::vector<double> centres_m;
    for (int i = 0; i < 40; ++i) centres_m.push_back(0.01 * i);
    core::DepthMap wires(centres_m, centres_m);
    core::DepthMap plates(centres_m, centres_m);
    for (std::size_t ix = 0; ix < 40; ++ix) {
        for (std::size_t iy = 0; iy < 40; ++iy) {
            if (ix % 8 == 3) wires.depth_m[wires.index(ix, iy)] = 0.7;
            if (ix % 8 >= 3) plates.depth_m[plates.index(ix, iy)] = 0.7 + 0.001 * double(ix);
        }
    }
    EXPECT_NE(coarse_truth_warning({{wires}, 4}).value().find("50 %"), std::string::npos);
    EXPECT_FALSE(coarse_truth_warning({{plates}, 4}));
}

}  // namespace
}  // namespace nlos
