// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/scene_geometry.h"
#include "renderer/scene/scene_file.h"

#include <string>

namespace python {

/// What Python calls a Scene: a description and the geometry that it is about.
struct SceneObject {
    std::string name;
    renderer::SceneDescription description;  ///< valid
    renderer::SceneGeometry geometry;        ///< with the description's objects applied
};

}  // namespace python
