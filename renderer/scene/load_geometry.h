// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/scene_geometry.h"
#include "renderer/scene/scene_file.h"

#include <string>
#include <vector>

namespace renderer {

/// Reads the geometry that a description names, a glTF or a mesh file, and applies what the
/// description says of it: unit, up axis, objects. Warnings name a size that hints at another unit.
///
/// throws   core::Error naming the file, or the object that it lacks
SceneGeometry load_geometry(const SceneDescription& description);

/// Replaces what a geometry says of its objects by what the description says.
/// throws   core::Error for an object that the geometry lacks
void apply_objects(const SceneDescription& description, SceneGeometry& geometry);

/// Reads a glTF file, or a mesh file in metres with y up.
SceneGeometry load_geometry(const std::string& path);

/// The name of a geometry file's format, for people.
std::string geometry_format(const std::string& path);

/// Says how the coordinates of the description's mesh file are taken, and what of it is assumed;
/// nothing for glTF, which states both.
std::vector<std::string> describe_frame(const SceneDescription& description);

}  // namespace renderer
