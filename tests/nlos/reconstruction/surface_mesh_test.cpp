// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nlos {
namespace {

/// A plane z = 0.5 + 0.3 x over 5 x 4 columns of 0.1 m, in a wall's frame that is turned and moved.
core::DepthMap sloped_plane() {
    core::DepthMap depth({0.0, 0.1, 0.2, 0.3, 0.4}, {0.0, 0.1, 0.2, 0.3});
    for (std::size_t ix = 0; ix < 5; ++ix) {
        for (std::size_t iy = 0; iy < 4; ++iy) {
            depth.depth_m[depth.index(ix, iy)] = 0.5 + 0.3 * depth.x_m[ix];
        }
    }
    depth.world_from_wall =
        Eigen::Translation3d(1.0, 2.0, 3.0) * Eigen::AngleAxisd(0.7, core::Vec3::UnitX());
    return depth;
}

core::Vec3 area_vector(const core::TriangleMesh& mesh, std::size_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    return core::triangle_area_vector(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
}

TEST(SurfaceMesh, CoversAPlaneWithFacetsTurnedTowardsTheWall) {
    const core::DepthMap depth = sloped_plane();
    const core::TriangleMesh mesh = surface_mesh(depth);
    EXPECT_EQ(mesh.vertices.size(), 20U);
    ASSERT_EQ(mesh.triangles.size(), 24U);
    const core::Vec3 towards_wall =
        depth.world_from_wall.linear() * core::Vec3(0.3, 0.0, -1.0).normalized();
    double area = 0.0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        EXPECT_LT((area_vector(mesh, i).normalized() - towards_wall).norm(), 1e-9);
        area += area_vector(mesh, i).norm();
    }
    EXPECT_NEAR(area, 0.4 * 0.3 * std::hypot(1.0, 0.3), 1e-9);
}

TEST(SurfaceMesh, LeavesOutBackgroundAndSteps) {
    core::DepthMap hole = sloped_plane();
    hole.depth_m[hole.index(2, 1)] = std::nan("");
    // Of the four cells around the hole two keep the triangle of the other three corners on their
    // joined diagonal, and two keep theirs on the other one.
    EXPECT_EQ(surface_mesh(hole).triangles.size(), 24U - 8U + 4U);
    core::DepthMap step = sloped_plane();
    for (std::size_t iy = 0; iy < 4; ++iy) step.depth_m[step.index(0, iy)] += 1.0;
    EXPECT_EQ(surface_mesh(step).triangles.size(), 24U - 6U);
}

TEST(SurfaceMesh, OfNothingIsEmpty) {
    EXPECT_TRUE(surface_mesh(core::DepthMap({0.0, 1.0}, {0.0, 1.0})).vertices.empty());
    EXPECT_TRUE(surface_mesh(core::DepthMap()).triangles.empty());
}

}  // namespace
}  // namespace nlos
