// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_fwd.h"
#include "renderer/core/settings/settings.h"
#include "renderer/material/scene_geometry.h"
#include "renderer/mesh_file/mesh_file.h"

#include <map>
#include <optional>
#include <string>

namespace renderer {

/// A material without a texture, in place of the file's.
struct MaterialSettings {
    SurfaceModel surface{};
    double albedo = 1.0;
    double roughness = 1.0;
};

/// An object of scene.json. With `mesh` it adds the objects of a file, which it places and gives
/// its name; without, it says of an object in the geometry's file what that does not.
struct ObjectSettings {
    std::optional<std::string> mesh;          ///< file, relative to scene.json
    std::optional<double> scale;              ///< world metres per unit of the file
    std::optional<FileAxis> up;               ///< of OBJ, PLY and STL files; nothing: y
    std::optional<core::Vec3> rotation_deg;   ///< about the world's x, then y, then z
    std::optional<core::Vec3> translation_m;  ///< after that
    std::optional<MaterialSettings> material;
    std::optional<Role> role;
    std::optional<double> albedo;
    std::optional<core::Vec3> velocity_m_per_s;
    std::optional<bool> retroreflective;
    std::optional<bool> ellipsoidal_exclude;
};

/// Objects by their name.
using ObjectTable = std::map<std::string, ObjectSettings>;

template <class Visitor>
void for_each_field(MaterialSettings& material, Visitor&& visit) {
    visit("surface", material.surface, "how it reflects");
    visit("albedo", material.albedo, core::between(0, 1, "fraction of light that is reflected"));
    visit("roughness", material.roughness, core::between(0, 1, "of models with a lobe"));
}

template <class Visitor>
void for_each_field(ObjectSettings& object, Visitor&& visit) {
    visit("mesh", object.mesh, "a file to add: .glb, .gltf, .obj, .ply or .stl");
    visit("scale", object.scale, core::above(0, "of the mesh: metres per unit of its file"));
    visit("up", object.up, "of an .obj, .ply or .stl mesh: its axis that is the world's y");
    visit("rotation_deg", object.rotation_deg, "of the mesh, about the world's x, then y, then z");
    visit("translation_m", object.translation_m, "of the mesh, after its rotation [m]");
    visit("material", object.material, "in place of the file's: surface, albedo, roughness");
    visit("role", object.role, "what the surface is to the measurement");
    visit("albedo", object.albedo, core::between(0, 1, "diffuse albedo"));
    visit("velocity_m_per_s", object.velocity_m_per_s, "velocity, world [m/s]");
    visit("retroreflective", object.retroreflective, "reflects light back where it came from");
    visit("ellipsoidal_exclude", object.ellipsoidal_exclude, "no ellipsoidal connection here");
}

/// A table is an object with one entry per name, or an array whose entries have a `name`, or that
/// of their mesh's file.
void read_value(const core::Json& json, const std::string& where, ObjectTable& objects);

/// Throws core::Error naming the key that is out of range, or says how a mesh lies where there is
/// none.
void validate(const ObjectTable& objects, const std::string& where);

}  // namespace renderer
