// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"

#include <functional>

namespace apps {

/// The image of the square [-1, 1]^2, cut into cells x cells squares of two triangles each, whose
/// diagonals run around the centre.
core::TriangleMesh make_grid_mesh(int cells,
                                  const std::function<core::Vec3(double u, double v)>& position);

/// A sphere of 2 cells^2 triangles with vertices on it: an octahedron's faces unfolded on a grid.
///
/// cells   even, so that edges of the octahedron are edges of triangles
core::TriangleMesh make_sphere_mesh(const core::Vec3& center, double radius_m, int cells);

}  // namespace apps
