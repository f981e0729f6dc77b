// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"

namespace apps {

/// A mesh for renderers that see one side of a surface only. A sheet gets that side turned to the
/// wall, triangle by triangle; what is closed has its outside there already.
core::TriangleMesh turned_to_wall(core::TriangleMesh mesh, const core::Vec3& wall_normal);

}  // namespace apps
