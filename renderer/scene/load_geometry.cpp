// SPDX-License-Identifier: MIT
#include "renderer/scene/load_geometry.h"

#include "renderer/gltf/gltf.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

namespace renderer {
namespace {

void apply(const ObjectSettings& settings, Object& object) {
    if (settings.retroreflective) {
        object.material.model =
            *settings.retroreflective ? SurfaceModel::Retroreflective : SurfaceModel::Lambertian;
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
void warn_of_size(const SceneDescription& description, SceneGeometry& geometry) {
    constexpr double kLargestRatio = 30.0;  // a centimetre taken for a metre is 100
    constexpr double kSmallestRatio = 0.01;
    const double size_m = diagonal_m(geometry);
    const auto& [width, height] = description.relay_wall.size_m;
    const double wall_m =
        description.camera ? (description.camera->look_at_m - description.camera->position_m).norm()
                           : std::hypot(width, height);
    if (size_m < kLargestRatio * wall_m && size_m > kSmallestRatio * wall_m) return;
    geometry.warnings.push_back(
        fmt::format("{} is {:.3g} m across{} {:.3g} m, if its unit is the metre; geometry_unit_m "
                    "states another "
                    "(0.001: millimetres, 0.01: centimetres, 0.0254: inches)",
                    description.geometry,
                    size_m,
                    description.camera ? ", seen by a camera that looks at a distance of"
                                       : ", beside a wall of",
                    wall_m));
}

}  // namespace

void apply_objects(const SceneDescription& description, SceneGeometry& geometry) {
    for (const auto& [name, settings] : description.objects) {
        bool is_there = false;
        std::string known;
        for (Object& object : geometry.objects) {
            if (object.name == name) {
                apply(settings, object);
                is_there = true;
            } else if (("," + known + ",").find("," + object.name + ",") == std::string::npos) {
                known += (known.empty() ? "" : ",") + object.name;
            }
        }
        if (is_there) continue;
        throw core::Error("objects." + name,
                          "is not in " + description.geometry,
                          "must be one of " + known.substr(0, 500));
    }
}

SceneGeometry load_geometry(const SceneDescription& description) {
    SceneGeometry geometry;
    if (is_mesh_file(description.geometry)) {
        geometry = load_mesh_file(description.geometry,
                                  {description.geometry_unit_m.value_or(MeshFrame{}.unit_m),
                                   description.geometry_up.value_or(MeshFrame{}.up)});
        if (!description.geometry_unit_m) warn_of_size(description, geometry);
    } else {
        geometry = load_gltf(description.geometry);
    }
    apply_objects(description, geometry);
    return geometry;
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
    const auto line = [](const std::string& what, bool is_stated, const char* key) {
        return is_stated ? what : what + " (assumed, the file states none: " + key + ")";
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
