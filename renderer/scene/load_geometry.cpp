// SPDX-License-Identifier: MIT
#include "renderer/scene/load_geometry.h"

#include "renderer/gltf/gltf.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <set>

namespace renderer {
namespace {

void apply(const ObjectSettings& settings, Object& object) {
    if (settings.material) {
        const auto& [surface, albedo, roughness] = *settings.material;
        object.material = {object.name, surface, albedo, roughness, nullptr};
        object.vertex_albedo.clear();
    }
    if (settings.retroreflective) {
        object.material.model = model_of({.retroreflective = *settings.retroreflective});
    }
    object.material.albedo = settings.albedo.value_or(object.material.albedo);
    object.role = settings.role.value_or(object.role);
    object.velocity_m_per_s = settings.velocity_m_per_s.value_or(object.velocity_m_per_s);
    object.ellipsoidal_exclude = settings.ellipsoidal_exclude.value_or(object.ellipsoidal_exclude);
}

double diagonal_m(const SceneGeometry& geometry) {
    Eigen::AlignedBox3d box;
    for (const Object& object : geometry.objects) {
        for (const core::Vec3& vertex : object.mesh.vertices) box.extend(vertex);
    }
    return box.diagonal().norm();
}

/// Names a size that no scene beside such a wall, or before such a camera, would have.
void warn_of_size(const SceneDescription& description,
                  const std::string& path,
                  const char* key,
                  SceneGeometry& geometry) {
    constexpr double kLargestRatio = 30.0;  // a centimetre taken for a metre is 100
    constexpr double kSmallestRatio = 0.01;
    const double size_m = diagonal_m(geometry);
    const auto& [width, height] = description.relay_wall.size_m;
    const double wall_m =
        description.camera ? (description.camera->look_at_m - description.camera->position_m).norm()
                           : std::hypot(width, height);
    if (size_m < kLargestRatio * wall_m && size_m > kSmallestRatio * wall_m) return;
    geometry.warnings.push_back(
        fmt::format("{} is {:.3g} m across{} {:.3g} m, if its unit is the metre; {} gives another "
                    "(0.001: millimetres, 0.01: centimetres, 0.0254: inches)",
                    path,
                    size_m,
                    description.camera ? ", seen by a camera that looks at a distance of"
                                       : ", beside a wall of",
                    wall_m,
                    key));
}

std::string path_of(const SceneDescription& description, const std::string& mesh) {
    return (std::filesystem::path(description.folder) / mesh).string();
}

core::Transform placement(const ObjectSettings& settings) {
    core::Transform world_from_mesh = core::Transform::Identity();
    world_from_mesh.translate(settings.translation_m.value_or(core::Vec3::Zero()));
    const core::Vec3 angles =
        settings.rotation_deg.value_or(core::Vec3::Zero()) / core::kDegreesPerRadian;
    for (const int axis : {2, 1, 0}) {
        world_from_mesh.rotate(Eigen::AngleAxisd(angles[axis], core::Vec3::Unit(axis)));
    }
    return world_from_mesh;
}

// The objects of a mesh's file, as one body of the name.
void add_placed(const SceneDescription& description,
                const std::string& name,
                const ObjectSettings& settings,
                SceneGeometry& geometry) {
    const std::string path = path_of(description, *settings.mesh);
    const double scale = settings.scale.value_or(1.0);
    core::Transform world_from_mesh = placement(settings);
    SceneGeometry added;
    if (is_mesh_file(path)) {
        added = load_mesh_file(path, {scale, settings.up.value_or(MeshFrame{}.up)});
        if (!settings.scale) warn_of_size(description, path, "scale", added);
    } else {
        added = load_gltf(path);
        world_from_mesh.scale(scale);
    }
    const core::Vec3 origin = added.objects.front().world_from_node.translation();
    for (Object& object : added.objects) {
        for (core::Vec3& vertex : object.mesh.vertices) vertex = world_from_mesh * vertex;
        object.mesh.normals.clear();
        object.name = name;
        object.groups.clear();
        object.world_from_node.translation() = origin;
        object.world_from_node = world_from_mesh * object.world_from_node;
        geometry.objects.push_back(std::move(object));
    }
    for (std::string& text : added.warnings) geometry.warnings.push_back(std::move(text));
}

}  // namespace

void apply_objects(const SceneDescription& description, SceneGeometry& geometry) {
    std::set<std::string> known;
    for (Object& object : geometry.objects) {
        known.insert(object.name);
        const auto settings = description.objects.find(object.name);
        if (settings != description.objects.end()) apply(settings->second, object);
    }
    for (const auto& [name, settings] : description.objects) {
        if (known.contains(name)) continue;
        throw core::Error(
            "objects." + name,
            "is not in " + geometry_name(description),
            "must be one of " + fmt::format("{}", fmt::join(known, ",")).substr(0, 500));
    }
}

SceneGeometry load_geometry(const SceneDescription& description) {
    SceneGeometry geometry;
    const std::string& path = description.geometry;
    if (is_mesh_file(path)) {
        geometry = load_mesh_file(path,
                                  {description.geometry_unit_m.value_or(MeshFrame{}.unit_m),
                                   description.geometry_up.value_or(MeshFrame{}.up)});
        if (!description.geometry_unit_m) {
            warn_of_size(description, path, "geometry_unit_m", geometry);
        }
    } else if (!path.empty()) {
        geometry = load_gltf(path);
    }
    for (const Object& object : geometry.objects) {
        const auto placed = description.objects.find(object.name);
        if (placed == description.objects.end() || !placed->second.mesh) continue;
        throw core::Error("objects." + object.name,
                          "has the name of an object in " + path,
                          "must have a name of its own to add " + *placed->second.mesh);
    }
    for (const auto& [name, settings] : description.objects) {
        if (settings.mesh) add_placed(description, name, settings, geometry);
    }
    apply_objects(description, geometry);
    return geometry;
}

std::string geometry_name(const SceneDescription& description) {
    return description.geometry.empty() ? "objects" : description.geometry;
}

std::vector<std::string> geometry_files(const SceneDescription& description) {
    std::vector<std::string> files;
    if (!description.geometry.empty()) files.push_back(description.geometry);
    for (const auto& [name, settings] : description.objects) {
        if (settings.mesh) files.push_back(path_of(description, *settings.mesh));
    }
    return files;
}

SceneGeometry load_geometry(const std::string& path) {
    return is_mesh_file(path) ? load_mesh_file(path, {}) : load_gltf(path);
}

std::string geometry_format(const std::string& path) {
    if (!is_mesh_file(path)) return "glTF 2.0";
    std::string name = std::filesystem::path(path).extension().string().substr(1);
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
        return static_cast<char>(std::toupper(c));
    });
    return name;
}

std::vector<std::string> describe_frame(const SceneDescription& description) {
    if (!is_mesh_file(description.geometry)) return {};
    const auto line = [](const std::string& what, bool is_given, const char* key) {
        return is_given ? what : what + " (assumed, the file gives none: " + key + ")";
    };
    const MeshFrame usual;
    return {line(fmt::format("unit: {:g} m", description.geometry_unit_m.value_or(usual.unit_m)),
                 description.geometry_unit_m.has_value(),
                 "geometry_unit_m"),
            line(fmt::format("up: {}", core::enum_name(description.geometry_up.value_or(usual.up))),
                 description.geometry_up.has_value(),
                 "geometry_up")};
}

}  // namespace renderer
