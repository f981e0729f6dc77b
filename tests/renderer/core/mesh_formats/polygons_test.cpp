// SPDX-License-Identifier: MIT
#include "renderer/core/mesh_formats/polygons.h"

#include "renderer/core/random.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace core {
namespace {

/// A polygon about the origin in a plane through the normal, whose corners lie at random radii.
TriangleMesh star(std::size_t corners, double smallest_radius, const Vec3& normal, Rng& rng) {
    const Vec3 u = normal.unitOrthogonal();
    const Vec3 v = normal.normalized().cross(u);
    TriangleMesh mesh;
    for (std::size_t i = 0; i < corners; ++i) {
        const double angle =
            2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(corners);
        const double radius = smallest_radius + (1.0 - smallest_radius) * rng.uniform();
        mesh.vertices.push_back(radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    return mesh;
}

void cut(TriangleMesh& mesh) {
    Polygons polygons;
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) polygons.corners.push_back(i);
    polygons.ends.push_back(polygons.corners.size());
    add_triangles("a.obj", polygons, 0, 1, mesh);
}

TEST(Polygons, TrianglesCoverThePolygonOnceAndFaceAsItDoes) {
    for (std::uint64_t trial = 0; trial < 300; ++trial) {
        Rng rng(3, trial, 0);
        const Vec3 normal(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5);
        TriangleMesh mesh = star(3 + trial % 60, trial % 3 == 0 ? 1.0 : 0.1, normal, rng);
        cut(mesh);
        ASSERT_EQ(mesh.triangles.size(), mesh.vertices.size() - 2);
        double expected = 0.0;
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
            const Vec3& next = mesh.vertices[(i + 1) % mesh.vertices.size()];
            expected += triangle_area_vector(Vec3::Zero(), mesh.vertices[i], next).norm();
        }
        double area = 0.0;
        for (const auto& [a, b, c] : mesh.triangles) {
            const Vec3 vector =
                triangle_area_vector(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
            EXPECT_GE(vector.dot(normal), -1e-12) << trial;
            area += vector.norm();
        }
        EXPECT_NEAR(area, expected, 1e-9) << trial;
    }
}

TEST(Polygons, LargeOnesAreReadWithoutDentsAndRefusedWithThem) {
    Rng rng(4, 0, 0);
    TriangleMesh round = star(100'000, 1.0, Vec3::UnitZ(), rng);
    cut(round);
    EXPECT_EQ(round.triangles.size(), 99'998U);
    TriangleMesh jagged = star(10'001, 0.5, Vec3::UnitZ(), rng);
    EXPECT_ERROR_WITH(cut(jagged), "a.obj: has a polygon of 10001 corners that is not convex");
}

TEST(Polygons, OnesThatCrossThemselvesAreCutIntoAsMany) {
    for (std::uint64_t trial = 0; trial < 100; ++trial) {
        Rng rng(5, trial, 0);
        TriangleMesh mesh;
        for (std::size_t i = 0; i < 3 + trial % 20; ++i) {
            mesh.vertices.emplace_back(rng.uniform(), rng.uniform(), rng.uniform());
        }
        cut(mesh);
        EXPECT_EQ(mesh.triangles.size(), mesh.vertices.size() - 2);
    }
}

}  // namespace
}  // namespace core
