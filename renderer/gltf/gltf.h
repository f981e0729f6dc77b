// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/scene_geometry.h"

#include <string>

namespace renderer {

/// Reads a glTF 2.0 file, text (.gltf) or binary (.glb) by content, into world coordinates.
///
/// Triangles, strips and fans become objects, by their morph targets, skins and instances as the
/// file poses them; animations are not played. Points and lines are left out, triangles without
/// area dropped. Metallic materials are rough conductors, others diffuse (see
/// render.dielectric_specular for the rest of what glTF says of these). What becomes of each
/// feature stands in gltf_features.h. The extras `nlos_role`, `nlos_ellipsoidal_exclude`,
/// `nlos_velocity_m_per_s`, `nlos_retroreflective` and `nlos_surface_model` are taken from the
/// node, else from its nearest ancestor that has them, else from the material.
///
/// path      the file; external buffers and images are searched for beside it
/// returns   at least one object, each with at least one triangle; perspective cameras
/// throws    core::Error naming the file and the offending part
/// source    [glTF2]
SceneGeometry load_gltf(const std::string& path);

/// Writes a binary glTF 2.0 file (.glb) that load_gltf reads back, one node per object.
///
/// Vertices are stored as floats relative to the object's node, so that far translations keep their
/// precision; albedo textures become 8-bit grey PNG images.
///
/// path       the target; appears whole or not at all
/// geometry   at least one object
/// throws     core::Error when an object cannot be expressed, core::Failure when the disk is full
/// source     [glTF2]
void write_gltf(const std::string& path, const SceneGeometry& geometry);

}  // namespace renderer
