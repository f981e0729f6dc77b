// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"
#include "renderer/material/scene_geometry.h"

#include <span>
#include <vector>

namespace renderer {

/// Per object, which side of its facets can ever be seen.
///
/// path_ends   see core::Scan
/// returns     +1 when the mesh is closed, consistently wound, and all these lie outside its
///             bounding box, and its facets' normals point outwards; -1 when they point inwards;
///             0 when both sides may be seen, as where connected parts of the mesh differ in that
std::vector<int> visible_sides(std::span<const Object> objects,
                               std::span<const core::Vec3> path_ends);

}  // namespace renderer
