// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene_import/scene_import.h"

#include <string>

namespace renderer {

/// Translates a scene of y-tal, as `tal render new` writes it: keys that are left out have the
/// values that y-tal gives them.
///
/// config   the YAML's content
/// path     of its file, from which meshes are found
/// throws   core::Error naming file and key
/// source   [Royo2022]
ImportedScene import_ytal(const core::Json& config, const std::string& path);

}  // namespace renderer
