// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"
#include "renderer/material/scene_geometry.h"
#include "tests/support/random_geometry.h"
#include "tests/support/test_scenes.h"

#include <cmath>
#include <string>
#include <vector>

namespace test_support {

/// A mesh whose parts hide one another, with an albedo per facet.
struct OccludedMesh {
    core::TriangleMesh mesh;
    std::vector<double> albedo;

    void add(const std::vector<core::Vec3>& vertices,
             const std::vector<std::array<std::uint32_t, 3>>& triangles,
             double value) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), vertices.begin(), vertices.end());
        for (const auto& [a, b, c] : triangles) {
            mesh.triangles.push_back({first + a, first + b, first + c});
            albedo.push_back(value);
        }
    }
    /// A parallelogram of two facets.
    void add(const Parallelogram& shape) {
        const auto object = parallelogram_object(shape);
        add(object.mesh.vertices, object.mesh.triangles, shape.albedo);
    }
};

/// A crumpled panel about (0, 0, 1), a black tetrahedron and two triangles before it, and a
/// triangle that pierces it: vertices 0 to 8, 9 to 12, 13 to 18 and 19 to 21.
inline OccludedMesh random_occluded_mesh(core::Rng& rng) {
    OccludedMesh result;
    std::vector<core::Vec3> grid;
    for (int i = 0; i < 9; ++i) {
        const core::Vec3 corner(0.3 * (i / 3 - 1), 0.3 * (i % 3 - 1), 1.0);
        grid.push_back(corner + 0.06 * random_point(rng));
    }
    std::vector<std::array<std::uint32_t, 3>> quads;
    for (const std::uint32_t i : {0U, 1U, 3U, 4U}) {
        quads.push_back({i, i + 3, i + 1});
        quads.push_back({i + 4, i + 1, i + 3});
    }
    result.add(grid, quads, 0.7);
    const auto around = [&](const core::Vec3& center, double radius, int count) {
        std::vector<core::Vec3> points;
        for (int i = 0; i < count; ++i) points.push_back(center + radius * random_point(rng));
        return points;
    };
    const core::Vec3 middle(0.0, 0.0, 0.6);
    result.add(around(middle + 0.1 * random_point(rng), 0.15, 4),
               {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}},
               0.0);
    for (int i = 0; i < 2; ++i) {
        const core::Vec3 center = core::Vec3(0.0, 0.0, 0.75) + 0.15 * random_point(rng);
        result.add(around(center, 0.2, 3), {{0, 1, 2}}, 0.4);
    }
    result.add(around(core::Vec3(0.0, 0.0, 1.0), 0.25, 3), {{0, 1, 2}}, 0.9);
    return result;
}

/// Points of a wall bent about the y axis, with its normals.
inline core::WallPoints curved_wall_points(std::size_t count, core::Rng& rng) {
    constexpr double kRadius_m = 2.0;
    core::WallPoints points;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 0.5 * (rng.uniform() - 0.5);
        const double y = rng.uniform() - 0.5;
        points.positions.emplace_back(
            kRadius_m * std::sin(angle), y, kRadius_m * (1.0 - std::cos(angle)));
        points.normals.emplace_back(-std::sin(angle), 0.0, std::cos(angle));
    }
    return points;
}

/// The mesh as objects of a renderer's scene, one per facet.
inline renderer::SceneGeometry geometry_of(const OccludedMesh& shapes) {
    renderer::SceneGeometry geometry;
    for (std::size_t f = 0; f < shapes.mesh.triangles.size(); ++f) {
        const auto& [a, b, c] = shapes.mesh.triangles[f];
        const auto& v = shapes.mesh.vertices;
        renderer::Object object =
            parallelogram_object({v[a], v[b] - v[a], v[c] - v[a], shapes.albedo[f]});
        object.name = "facet " + std::to_string(f);
        object.mesh = {{v[a], v[b], v[c]}, {{0, 1, 2}}, {}};
        geometry.objects.push_back(std::move(object));
    }
    return geometry;
}

}  // namespace test_support
