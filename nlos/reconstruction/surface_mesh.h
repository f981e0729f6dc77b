// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/depth_map.h"
#include "renderer/core/mesh.h"

namespace nlos {

/// Joins neighbouring foreground columns of a depth map by triangles.
///
/// Corners further apart in depth than 4 times their lateral distance belong to different surfaces
/// and stay unjoined.
///
/// returns   vertices and normals in world coordinates, facets turned towards the wall; empty when
///           no three neighbours are foreground
/// throws    nothing
core::TriangleMesh surface_mesh(const core::DepthMap& depth);

}  // namespace nlos
