// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/volume.h"
#include "renderer/core/depth_map.h"
#include "renderer/core/mesh.h"

namespace nlos {

/// The surface that a volume shows from the wall: where each column is brightest.
///
/// The depth between voxels is the vertex of a parabola through the logarithms of the brightest
/// voxel and its two neighbours. Normals are those of planes fitted to neighbouring foreground
/// columns.
///
/// mask_threshold   share of the volume's maximum from which on a column is foreground, in (0, 1)
/// returns          depth in the wall's frame, NaN = background; normals in world, zero where
///                  background; nothing is foreground in a volume without positive values
/// throws           nothing
core::DepthMap extract_depth_map(const Volume& volume, double mask_threshold);

}  // namespace nlos
