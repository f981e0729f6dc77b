// SPDX-License-Identifier: MIT
#include "renderer/core/true_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using core::DepthMap;
using core::TrueSurface;
using core::Vec3;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<double> centres(std::size_t count, double width_m) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(width_m * static_cast<double>(i));
    return values;
}

/// A view of `columns` x `columns` columns of 0.1 m whose depth is a function of x and y.
template <class Depth>
DepthMap view_of(std::size_t columns, std::size_t per_side, Depth&& depth) {
    const std::vector<double> parts = core::parts_of_cells(centres(columns, 0.1), per_side);
    DepthMap view(parts, parts);
    for (std::size_t ix = 0; ix < parts.size(); ++ix) {
        for (std::size_t iy = 0; iy < parts.size(); ++iy) {
            view.depth_m[view.index(ix, iy)] = depth(parts[ix], parts[iy]);
        }
    }
    return view;
}

TEST(TrueSurface, PartsOfCellsFillThemEvenly) {
    const std::vector<double> parts = core::parts_of_cells({1.0, 2.0}, 2);
    ASSERT_EQ(parts.size(), 4U);
    const double expected[] = {0.75, 1.25, 1.75, 2.25};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(parts[i], expected[i]);
    EXPECT_EQ(core::parts_of_cells({2.0, 1.0}, 2), (std::vector<double>{2.25, 1.75, 1.25, 0.75}))
        << "in the order of the cells";
    EXPECT_EQ(core::parts_of_cells({3.0}, 2), (std::vector<double>{3.0, 3.0}));
}

TEST(TrueSurface, ASlopeIsOneSurfaceWithTheDepthOfItsMiddle) {
    const TrueSurface truth({view_of(4, 8, [](double x, double y) { return 1.0 + 2.0 * x - y; })},
                            8);
    for (std::size_t i = 0; i < truth.columns.size(); ++i) {
        ASSERT_EQ(truth.columns[i].size(), 1U);
        const double x = truth.main.x_m[i / 4];
        const double y = truth.main.y_m[i % 4];
        EXPECT_NEAR(truth.columns[i][0].depth_m, 1.0 + 2.0 * x - y, 1e-12);
        EXPECT_DOUBLE_EQ(truth.covered(i), 1.0);
        EXPECT_NEAR(truth.main.depth_m[i], 1.0 + 2.0 * x - y, 1e-12);
    }
    EXPECT_EQ(truth.samples.positions.size(), 32U * 32U);
    EXPECT_LT(truth.lost_at_half, 1e-3);
}

TEST(TrueSurface, WhatFallsBetweenColumnsIsSeen) {
    // A bar 30 mm wide between the centres of the first two columns, a wall behind it from x = 0.2.
    const auto depth = [](double x, double) {
        if (std::abs(x - 0.05) < 0.015) return 0.6;
        return x > 0.2 ? 0.9 : kNone;
    };
    const TrueSurface truth({view_of(4, 20, depth)}, 20);
    for (const std::size_t ix : {0U, 1U}) {
        const auto& column = truth.columns[truth.main.index(ix, 0)];
        ASSERT_EQ(column.size(), 1U);
        EXPECT_NEAR(column[0].depth_m, 0.6, 1e-12);
        EXPECT_NEAR(column[0].fraction, 0.15, 1e-12);
    }
    EXPECT_NEAR(truth.covered(truth.main.index(2, 0)), 0.5, 1e-12);
}

TEST(TrueSurface, NearestOfSeveralSurfacesIsTaken) {
    const auto depth = [](double x, double) { return x < 0.02 ? 0.6 : 0.9; };
    const TrueSurface truth({view_of(2, 20, depth)}, 20);
    ASSERT_EQ(truth.columns[0].size(), 2U);
    EXPECT_NEAR(truth.main.depth_m[0], 0.6, 1e-12) << "which covers 70 %";
    DepthMap found(truth.main.x_m, truth.main.y_m);
    found.depth_m[0] = 0.8;
    const DepthMap nearest = core::nearest_surfaces(truth, found);
    EXPECT_NEAR(nearest.depth_m[0], 0.9, 1e-12);
    EXPECT_NEAR(nearest.depth_m[1], 0.6, 1e-12) << "where nothing was found";
}

TEST(TrueSurface, DensePointsOfAPlaneLieOnIt) {
    DepthMap plane(centres(5, 0.1), centres(6, 0.1));
    for (std::size_t ix = 0; ix < 5; ++ix) {
        for (std::size_t iy = 0; iy < 6; ++iy) {
            plane.depth_m[plane.index(ix, iy)] = 0.5 + 0.6 * plane.x_m[ix] - 0.3 * plane.y_m[iy];
        }
    }
    plane.world_from_wall.translate(Vec3(1.0, 2.0, 3.0));
    const core::PointCloud dense = core::dense_points(plane, 4);
    EXPECT_EQ(dense.positions.size(), 5U * 6U * 16U);
    for (const Vec3& point : dense.positions) {
        const Vec3 local = point - Vec3(1.0, 2.0, 3.0);
        EXPECT_NEAR(local.z(), 0.5 + 0.6 * local.x() - 0.3 * local.y(), 1e-12);
    }
}

TEST(TrueSurface, DensePointsDoNotBridgeAnEdge) {
    DepthMap step(centres(6, 0.1), centres(1, 0.1));
    step.depth_m = {0.5, 0.5, 0.5, 0.9, 0.9, kNone};
    for (const Vec3& point : core::dense_points(step, 4).positions) {
        EXPECT_DOUBLE_EQ(point.z(), point.x() < 0.25 ? 0.5 : 0.9);
    }
}

}  // namespace
