// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_fwd.h"
#include "renderer/material/scene_geometry.h"
#include "renderer/scene/scene_file.h"

#include <string>
#include <vector>

namespace renderer {

/// A scene of another program, as far as this one knows the same things.
struct ImportedScene {
    SceneDescription description;  ///< its geometry names no file yet
    SceneGeometry geometry;        ///< world; without the relay wall, which the description holds
    /// What was left out, or is meant differently, one line each.
    std::vector<std::string> not_translated;
};

/// Translates a scene of Mitsuba 3 with mitransient (XML, or its Python dictionary as JSON) or of
/// y-tal (YAML), with the meshes that it names.
///
/// path     the scene; mesh files are looked for beside it
/// throws   core::Error naming the file and the part that is wrong, or without which there is no
///          scan of a relay wall
/// source   [Royo2022], [Jakob2022]
ImportedScene import_scene(const std::string& path);

/// What scene.json says of an imported scene, with `geometry` as the name of its glTF file.
core::Json imported_scene_json(const ImportedScene& scene, const std::string& geometry);

}  // namespace renderer
