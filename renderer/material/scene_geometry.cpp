// SPDX-License-Identifier: MIT
#include "renderer/material/scene_geometry.h"

namespace renderer {

void SceneGeometry::move(const core::Vec3& way) {
    for (Object& object : objects) {
        for (core::Vec3& vertex : object.mesh.vertices) vertex += way;
        object.world_from_node.pretranslate(way);
        for (NodeGroup& group : object.groups) group.world_from_node.pretranslate(way);
    }
    for (Camera& camera : cameras) camera.position += way;
}

}  // namespace renderer
