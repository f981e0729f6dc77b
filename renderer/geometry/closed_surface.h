// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/material/scene_geometry.h"

namespace renderer {

/// Which side of an object's facets can ever be seen.
///
/// scan      wall points, or camera and light
/// returns   +1 when the mesh is closed, consistently wound, and all these lie outside its
///           bounding box, and its facets' normals point outwards; -1 when they point inwards;
///           0 when both sides may be seen
int visible_side(const Object& object, const core::Scan& scan);

}  // namespace renderer
