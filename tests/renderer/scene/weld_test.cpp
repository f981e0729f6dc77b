// SPDX-License-Identifier: MIT
#include "renderer/scene/weld.h"

#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <set>

namespace {

using core::TriangleMesh;
using core::Vec3;

std::size_t num_positions(const TriangleMesh& mesh) {
    std::set<std::array<double, 3>> positions;
    for (const Vec3& v : mesh.vertices) positions.insert({v.x(), v.y(), v.z()});
    return positions.size();
}

TriangleMesh welded(TriangleMesh mesh) {
    renderer::weld_vertices(mesh);
    return mesh;
}

TEST(Weld, JoinsTheSeamsOfASphere) {
    constexpr int kCells = 12;
    constexpr std::size_t kPositions = 2 * kCells * (kCells - 1) + 2;
    const TriangleMesh sphere = test_support::seamed_sphere(Vec3(0.05, 0.02, 0.7), 0.2, kCells);
    EXPECT_EQ(num_positions(welded(sphere)), kPositions);
    TriangleMesh in_single_precision = sphere;
    for (Vec3& v : in_single_precision.vertices) v = v.cast<float>().cast<double>();
    EXPECT_EQ(num_positions(welded(in_single_precision)), kPositions);
    TriangleMesh far_away = sphere;
    for (Vec3& v : far_away.vertices) v += Vec3(0.5e6, -1e6, 0.7e6);
    EXPECT_EQ(num_positions(welded(far_away)), kPositions);
}

TEST(Weld, MovesNothingByMoreThanRounding) {
    const TriangleMesh sphere = test_support::seamed_sphere(Vec3(0.05, 0.02, 0.7), 0.2, 24);
    const TriangleMesh result = welded(sphere);
    ASSERT_EQ(result.vertices.size(), sphere.vertices.size());
    EXPECT_EQ(result.triangles, sphere.triangles);
    for (std::size_t i = 0; i < sphere.vertices.size(); ++i) {
        EXPECT_LT((result.vertices[i] - sphere.vertices[i]).norm(), 1e-15);
    }
}

/// Wherever they lie among the cells of the search.
TEST(Weld, JoinsPairsAtAnyPlace) {
    for (int i = 0; i < 1000; ++i) {
        const double x = 1e-3 * i;
        TriangleMesh mesh;
        mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {x, 0.5, 0}, {x + 0.9e-7, 0.5, 0}};
        mesh.triangles = {{0, 1, 2}};
        EXPECT_EQ(welded(mesh).vertices[4].x(), x);
        mesh.vertices[4].x() = x + 1.1e-7;
        EXPECT_NE(welded(mesh).vertices[4].x(), x);
    }
}

TEST(Weld, LeavesMeshesWithTrianglesOfThatSize) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5e-8, 0, 0}, {0, 5e-8, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
    EXPECT_EQ(welded(mesh).vertices, mesh.vertices);
}

}  // namespace
