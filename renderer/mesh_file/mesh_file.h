// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"
#include "renderer/material/scene_geometry.h"

#include <string>

namespace renderer {

/// An axis of a file's coordinates.
enum class FileAxis { X, MinusX, Y, MinusY, Z, MinusZ };

/// How the coordinates of a mesh file lie in the world, which is in metres with y up.
struct MeshFrame {
    double unit_m = 1.0;        ///< length of the file's unit [m]
    FileAxis up = FileAxis::Y;  ///< the file's axis that becomes the world's y
};

/// True for names of Wavefront OBJ, PLY and STL files (.obj, .ply, .stl in any case). These formats
/// state neither units nor axes.
bool is_mesh_file(const std::string& path);

/// Reads a Wavefront OBJ, PLY or STL file into world coordinates, as load_gltf reads glTF.
///
/// Objects and groups of the file become objects, one per material, all hidden; z up turns about x,
/// as exporters of glTF do, x up about z. The origin of each is the centre of its box. Triangles
/// without area are dropped. The diffuse colour of a material (Kd) is taken as linear, as it
/// stands, and counts as its mean; without one the albedo is 1. Metals (Pm above 0) reflect by GGX
/// with roughness Pr, all others are diffuse.
///
/// path      the file; material files (MTL) are searched for beside it
/// returns   at least one object, each with at least one triangle; no cameras
/// throws    core::Error naming the file and what is wrong with it
/// source    [Wavefront1995], [Turk1994]
SceneGeometry load_mesh_file(const std::string& path, const MeshFrame& frame);

}  // namespace renderer

template <>
struct core::EnumNames<renderer::FileAxis> {
    static constexpr auto value =
        names_from_zero<renderer::FileAxis>("x", "-x", "y", "-y", "z", "-z");
};
