// SPDX-License-Identifier: MIT
#include "renderer/scene_import/foreign_shapes.h"

#include <map>
#include <numbers>

namespace renderer {
namespace {

using core::TriangleMesh;
using core::Vec3;

constexpr int kSegments = 64;           // of circles
constexpr int kSphereSubdivisions = 4;  // of an octahedron: 2,048 triangles

TriangleMesh rectangle() {
    TriangleMesh mesh;
    mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

TriangleMesh cube() {
    TriangleMesh mesh;
    for (int corner = 0; corner < 8; ++corner) {
        mesh.vertices.emplace_back(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    }
    constexpr std::uint32_t kFaces[6][4]{
        {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& [a, b, c, d] : kFaces) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    }
    return mesh;
}

Vec3 on_circle(int segment, double z) {
    const double angle = 2.0 * std::numbers::pi * segment / kSegments;
    return {std::cos(angle), std::sin(angle), z};
}

TriangleMesh disk() {
    TriangleMesh mesh;
    mesh.vertices.push_back(Vec3::Zero());
    for (std::uint32_t i = 0; i < kSegments; ++i) {
        mesh.vertices.push_back(on_circle(static_cast<int>(i), 0.0));
        mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % kSegments});
    }
    return mesh;
}

TriangleMesh cylinder() {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < kSegments; ++i) {
        mesh.vertices.push_back(on_circle(static_cast<int>(i), 0.0));
        mesh.vertices.push_back(on_circle(static_cast<int>(i), 1.0));
        const std::uint32_t next = 2 * ((i + 1) % kSegments);
        mesh.triangles.push_back({2 * i, next, next + 1});
        mesh.triangles.push_back({2 * i, next + 1, 2 * i + 1});
    }
    return mesh;
}

/// Cuts every triangle into four and moves the new corners onto the unit sphere.
TriangleMesh subdivided(const TriangleMesh& coarse) {
    TriangleMesh fine;
    fine.vertices = coarse.vertices;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [place, is_new] = middles.try_emplace(
            std::minmax(a, b), static_cast<std::uint32_t>(fine.vertices.size()));
        if (is_new) {
            fine.vertices.push_back((coarse.vertices[a] + coarse.vertices[b]).normalized());
        }
        return place->second;
    };
    for (const auto& [a, b, c] : coarse.triangles) {
        const std::uint32_t ab = middle(a, b);
        const std::uint32_t bc = middle(b, c);
        const std::uint32_t ca = middle(c, a);
        fine.triangles.push_back({a, ab, ca});
        fine.triangles.push_back({ab, b, bc});
        fine.triangles.push_back({ca, bc, c});
        fine.triangles.push_back({ab, bc, ca});
    }
    return fine;
}

TriangleMesh sphere() {
    TriangleMesh mesh;
    mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {
        {0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int i = 0; i < kSphereSubdivisions; ++i) mesh = subdivided(mesh);
    return mesh;
}

}  // namespace

std::optional<TriangleMesh> foreign_shape(const std::string& type) {
    if (type == "rectangle") return rectangle();
    if (type == "cube") return cube();
    if (type == "disk") return disk();
    if (type == "sphere") return sphere();
    if (type == "cylinder") return cylinder();
    return std::nullopt;
}

bool is_round(const std::string& type) {
    return type == "disk" || type == "sphere" || type == "cylinder";
}

}  // namespace renderer
