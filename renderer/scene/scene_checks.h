// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"

namespace renderer {

/// Throws core::Error naming the file or the object when a vertex is not finite, all hidden
/// surfaces lie behind the scan's points, or a sensor looks at a mesh in place of the rectangle.
void check_geometry(const SceneGeometry& geometry,
                    const SceneDescription& description,
                    const core::Scan& scan);

/// Adds warnings of wall points off the rectangle of the relay wall, and of objects that reach
/// behind it. For geometry that brings no mesh of the wall itself.
void warn_of_placement(const SceneDescription& description,
                       const core::Scan& scan,
                       SceneGeometry& geometry);

/// Throws core::Error when no hidden surface is left of the geometry, or one lies so near in front
/// of a wall point that methods disagree about its light.
void check_scene(const Scene& scene, const SceneDescription& description, const core::Scan& scan);

/// Throws core::Error when a grid of points does not lie on the mesh that is the relay wall.
void check_wall_mesh(const Scene& scene,
                     const SceneDescription& description,
                     const core::Scan& scan);

}  // namespace renderer
