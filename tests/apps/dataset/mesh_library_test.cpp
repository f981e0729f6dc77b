// SPDX-License-Identifier: MIT
#include "apps/dataset/mesh_library.h"

#include "apps/shapes/shapes.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using core::Vec3;

TEST(MeshLibrary, NormalisedMeshesHaveTheirBoxAroundTheOriginWithALongestSideOfOne) {
    core::TriangleMesh mesh = apps::make_sphere_mesh(Vec3(100.0, -3.0, 5.0), 7.0, 8);
    for (Vec3& p : mesh.vertices) p.y() *= 0.5;
    mesh.vertices.emplace_back(1e6, 0.0, 0.0);  // used by no triangle
    const core::TriangleMesh unit = apps::normalise_mesh(mesh, "sphere");
    Eigen::AlignedBox3d box;
    for (const Vec3& p : unit.vertices) box.extend(p);
    EXPECT_NEAR(box.center().norm(), 0.0, 1e-12);
    EXPECT_NEAR(box.sizes().x(), 1.0, 1e-12);
    EXPECT_NEAR(box.sizes().y(), 0.5, 1e-12);
    EXPECT_EQ(unit.triangles.size(), mesh.triangles.size());
}

TEST(MeshLibrary, RefusesSurfacesThatAreNone) {
    core::TriangleMesh line;
    line.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)};
    line.triangles = {{0, 1, 2}};
    EXPECT_ERROR_WITH(apps::normalise_mesh(line, "line.obj"), "line.obj: has no triangle");
    line.vertices[1].y() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_ERROR_WITH(apps::normalise_mesh(line, "line.obj"), "not finite");
}

TEST(MeshLibrary, SimplifiedSpheresStayWithinTheToleranceAndLoseMostTriangles) {
    const core::TriangleMesh sphere =
        apps::normalise_mesh(apps::make_sphere_mesh(Vec3::Zero(), 1.0, 100), "sphere");
    constexpr double kTolerance = 0.002;
    const core::TriangleMesh simple = apps::simplify_mesh(sphere, kTolerance);
    EXPECT_LT(simple.triangles.size(), sphere.triangles.size() / 4);
    EXPECT_GT(simple.triangles.size(), 100u);
    for (const auto& [a, b, c] : simple.triangles) {
        // Of a sphere of radius 0.5: corners lie on it, centres of facets inside. Quadrics bound
        // the root mean square, so that a facet may err by more.
        const Vec3 centre = (simple.vertices[a] + simple.vertices[b] + simple.vertices[c]) / 3.0;
        EXPECT_NEAR(centre.norm(), 0.5, 4.0 * kTolerance);
    }
}

TEST(MeshLibrary, SimplifiedPlatesKeepTheirCorners) {
    const core::TriangleMesh plate = apps::normalise_mesh(
        apps::make_grid_mesh(20, [](double u, double v) { return Vec3(u, v, 0.0); }), "plate");
    const core::TriangleMesh simple = apps::simplify_mesh(plate, 0.001);
    EXPECT_LE(simple.triangles.size(), 8u);
    Eigen::AlignedBox3d box;
    for (const Vec3& p : simple.vertices) box.extend(p);
    EXPECT_NEAR(box.sizes().x(), 1.0, 1e-9);
    EXPECT_NEAR(box.sizes().y(), 1.0, 1e-9);
}

}  // namespace
