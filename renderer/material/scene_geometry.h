// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"
#include "renderer/core/settings/settings.h"
#include "renderer/core/types.h"
#include "renderer/material/material.h"

#include <string>
#include <vector>

namespace renderer {

/// What a surface is to the measurement.
enum class Role { Hidden, RelayWall, BackWall };

/// A node of a glTF file above another.
struct NodeGroup {
    std::string name;
    core::Transform world_from_node = core::Transform::Identity();
};

/// Triangles of one material that move as one.
struct Object {
    std::string name;  ///< of the glTF node; several objects share it when a node has several
    core::TriangleMesh mesh;     ///< world coordinates; no triangle without area
    std::vector<core::Vec2> uv;  ///< texture coordinate per vertex; empty when there are none
    std::vector<double> vertex_albedo{};  ///< factors of the albedo per vertex; empty: all are 1
    Material material;
    Role role = Role::Hidden;
    bool ellipsoidal_exclude = false;  ///< left out of the ellipsoidal connection technique
    core::Vec3 velocity_m_per_s = core::Vec3::Zero();  ///< world
    core::Transform world_from_node =
        core::Transform::Identity();  ///< where the node put it; translation() is its origin
    std::vector<NodeGroup>
        groups{};  ///< the nearest nodes above it that have a name, outermost first

    /// Whether the albedo is the material's everywhere.
    bool has_one_albedo() const { return !material.albedo_texture && vertex_albedo.empty(); }
};

/// A pinhole camera.
struct Camera {
    std::string name;                           ///< of the glTF node, else of the camera
    core::Vec3 position = core::Vec3::Zero();   ///< [m, world]
    core::Vec3 forward = -core::Vec3::UnitZ();  ///< unit
    core::Vec3 up = core::Vec3::UnitY();        ///< unit, perpendicular to forward
    double fov_y_rad = 0.0;                     ///< full vertical angle of view
    std::string lens_name;                      ///< of the glTF camera, which nodes may share
};

/// What a glTF file holds, flattened to world coordinates.
struct SceneGeometry {
    std::vector<Object> objects;          ///< an instanced mesh appears once per instance
    std::vector<Camera> cameras;          ///< perspective ones
    std::vector<std::string> warnings{};  ///< what the file says that is not modelled, for people

    /// Moves all of it.
    void move(const core::Vec3& way);
};

}  // namespace renderer

template <>
struct core::EnumNames<renderer::Role> {
    static constexpr auto value =
        names_from_zero<renderer::Role>("hidden", "relay_wall", "back_wall");
};
