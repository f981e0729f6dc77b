// SPDX-License-Identifier: MIT
#include "renderer/scene_import/imported_shapes.h"

#include "renderer/core/error.h"
#include "renderer/core/system/process.h"
#include "renderer/mesh_file/mesh_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <utility>

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
        const auto [entry, is_new] = middles.try_emplace(
            std::minmax(a, b), static_cast<std::uint32_t>(fine.vertices.size()));
        if (is_new) {
            fine.vertices.push_back((coarse.vertices[a] + coarse.vertices[b]).normalized());
        }
        return entry->second;
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

/// The triangles of a built-in shape of Mitsuba in its own coordinates; round ones are cut into
/// facets whose corners lie on the surface.
///
/// type      rectangle (x, y from -1 to 1), cube (-1 to 1), disk (radius 1 in x, y), sphere (radius
///           1) or cylinder (radius 1 around z from 0 to 1, open)
/// returns   nothing for another type
std::optional<TriangleMesh> foreign_shape(const std::string& type) {
    if (type == "rectangle") return rectangle();
    if (type == "cube") return cube();
    if (type == "disk") return disk();
    if (type == "sphere") return sphere();
    if (type == "cylinder") return cylinder();
    return std::nullopt;
}

/// True for shapes that foreign_shape() cuts into facets.
bool is_round(const std::string& type) {
    return type == "disk" || type == "sphere" || type == "cylinder";
}

/// All triangles of a mesh file, whose materials the scene replaces.
TriangleMesh mesh_of_file(const std::string& file, const std::string& where) {
    if (!is_mesh_file(file)) {
        throw core::Error(where, "names " + file, "must be an .obj, .ply or .stl file");
    }
    TriangleMesh all;
    for (const Object& object : load_mesh_file(file, {}).objects) {
        core::append_mesh(object.mesh, all);
    }
    return all;
}

TriangleMesh placed(const TriangleMesh& mesh, const core::Transform& to_world) {
    TriangleMesh result;
    for (const Vec3& vertex : mesh.vertices) result.vertices.push_back(to_world * vertex);
    const bool is_mirrored = to_world.linear().determinant() < 0.0;
    for (auto [a, b, c] : mesh.triangles) {
        const Vec3& corner = result.vertices[a];
        if (!core::has_area(result.vertices[b] - corner, result.vertices[c] - corner)) continue;
        if (is_mirrored) std::swap(b, c);
        result.triangles.push_back({a, b, c});
    }
    return result;
}

/// Instances of one file can multiply it beyond any memory.
void check_memory(const SceneGeometry& geometry, const std::string& where) {
    double bytes = 0.0;
    for (const Object& object : geometry.objects) {
        bytes += static_cast<double>(object.mesh.vertices.size() * sizeof(Vec3) +
                                     object.mesh.triangles.size() * 3 * sizeof(std::uint32_t));
    }
    constexpr double kAlwaysThere = 1e8;
    if (bytes < kAlwaysThere) return;
    const auto available = static_cast<double>(core::available_memory_bytes());
    if (bytes < available / 2.0) return;
    throw core::Error(where,
                      fmt::format("makes {:.3g} bytes of geometry", bytes),
                      fmt::format("must fit into half of the {:.3g} free bytes", available));
}

/// The relay wall that a rectangle becomes; its albedo stays as it is.
RelayWall rectangle_wall(const core::Transform& to_world, const std::string& where) {
    const Vec3 x = to_world.linear().col(0);
    const Vec3 y = to_world.linear().col(1);
    const double area = x.cross(y).norm();
    if (!(area > 0.0) || std::abs(x.dot(y)) > 1e-6 * area) {
        throw core::Error(
            where, "is no rectangle in the world", "must have right angles and an area");
    }
    RelayWall wall;
    wall.center_m = to_world.translation();
    // Normals go with the inverse transpose, which turns over with a mirroring.
    const double side = to_world.linear().determinant() < 0.0 ? -1.0 : 1.0;
    wall.normal = side * x.cross(y).normalized();
    wall.up = y.normalized();
    wall.size_m = {2.0 * x.norm(), 2.0 * y.norm()};
    return wall;
}

}  // namespace

void add_shape(const ForeignShape& shape,
               const std::string& path,
               const std::string& where,
               ImportedScene& scene) {
    namespace fs = std::filesystem;
    const std::string key = where.substr(path.size() + 2);
    Object object;
    const std::optional<TriangleMesh> built_in = foreign_shape(shape.type);
    if (built_in) {
        object.mesh = placed(*built_in, shape.to_world);
    } else if (shape.type == "obj" || shape.type == "ply" || shape.type == "stl") {
        const std::string file = (fs::path(path).parent_path() / shape.filename).string();
        object.mesh = placed(mesh_of_file(file, where), shape.to_world);
    } else {
        scene.not_translated.push_back(key + ": a shape of type " + shape.type + " is left out");
        return;
    }
    if (object.mesh.triangles.empty()) {
        throw core::Error(where, "has no triangles with an area", "must have at least one");
    }
    if (is_round(shape.type)) {
        scene.not_translated.push_back(fmt::format(
            "{}: the {} is cut into {} triangles", key, shape.type, object.mesh.triangles.size()));
    }
    object.name = shape.name;
    object.material = shape.material;
    object.world_from_node.translation() = shape.to_world.translation();
    scene.geometry.objects.push_back(std::move(object));
    check_memory(scene.geometry, where);
}

void require_rectangle(const ForeignShape& shape, const std::string& where) {
    if (shape.type == "rectangle") return;
    throw core::Error(where,
                      "is a relay wall of type " + shape.type.substr(0, 60),
                      "must be a rectangle, whose points are known");
}

void set_relay_wall(const ForeignShape& shape, const std::string& where, ImportedScene& scene) {
    scene.description.relay_wall = rectangle_wall(shape.to_world, where);
    scene.description.relay_wall.albedo = shape.material.albedo;
    if (!(shape.to_world.linear().determinant() > 0.0)) {
        scene.not_translated.emplace_back(
            "columns of wall points run against those of the foreign scene, whose wall is "
            "mirrored");
    }
    if (!traits_of(shape.material.model).is_constant) {
        scene.not_translated.emplace_back(
            "the relay wall is diffuse here, with its reflectance as albedo");
    }
}

void note_laser_power(const std::string& key, ImportedScene& scene) {
    scene.not_translated.push_back(
        key +
        ": its power is not translated: each spot gets 1 W here, there the less the farther "
        "it is");
}

void set_bounces(const ForeignBounces& bounces, ImportedScene& scene) {
    constexpr int kFewest = 3;  // wall, object, wall
    constexpr int kUnlimited = 5;
    int& most = scene.description.render.max_bounces;
    if (bounces.filter > 0) {
        most = bounces.filter;
        scene.not_translated.push_back(fmt::format(
            "filter_bounces: light of all orders from 3 to {} is rendered{}",
            std::max(kFewest, most),
            bounces.laser_sampling ? "; mitransient 1.3 with nlos_laser_sampling keeps one more"
                                   : ""));
    } else if (bounces.max_depth < 0) {
        most = kUnlimited;
        scene.not_translated.push_back(
            fmt::format("max_depth: bounces are unlimited there, at most {} here", kUnlimited));
    } else {
        // Measured with mitransient 1.3.1: see ForeignBounces.
        most = bounces.laser_sampling ? bounces.max_depth : bounces.max_depth - 1;
    }
    most = std::max(kFewest, most);
}

}  // namespace renderer
