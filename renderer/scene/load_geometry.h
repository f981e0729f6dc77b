// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/scene_geometry.h"
#include "renderer/scene/scene_file.h"

#include <string>
#include <vector>

namespace renderer {

/// Reads the geometry that a description names, a glTF or a mesh file, adds the meshes of its
/// objects, and applies what it says of both: unit, up axis, objects. Warnings name a size that
/// hints at another unit.
///
/// throws   core::Error naming the file, or the object that it lacks
SceneGeometry load_geometry(const SceneDescription& description);

/// Replaces what a geometry says of its objects by what the description says.
/// throws   core::Error for an object that the geometry lacks
void apply_objects(const SceneDescription& description, SceneGeometry& geometry);

/// What messages call the geometry: its file, or `objects` where there is none.
std::string geometry_name(const SceneDescription& description);

/// Paths of all files that hold the geometry: its own and the meshes of objects.
std::vector<std::string> geometry_files(const SceneDescription& description);

/// Reads a glTF file, or a mesh file in metres with y up.
SceneGeometry load_geometry(const std::string& path);

/// The name of a geometry file's format, for people.
std::string geometry_format(const std::string& path);

/// Says how the coordinates of the description's mesh file are taken, and what of it is assumed;
/// nothing for glTF, which gives both.
std::vector<std::string> describe_frame(const SceneDescription& description);

}  // namespace renderer
