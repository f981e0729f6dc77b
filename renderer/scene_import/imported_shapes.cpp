// SPDX-License-Identifier: MIT
#include "renderer/scene_import/imported_shapes.h"

#include "renderer/core/error.h"
#include "renderer/core/process.h"
#include "renderer/mesh_file/mesh_file.h"
#include "renderer/scene_import/foreign_shapes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

namespace renderer {
namespace {

using core::TriangleMesh;
using core::Vec3;

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
    if (shape.material.model != SurfaceModel::Lambertian) {
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
