// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"
#include "renderer/core/settings/settings.h"

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

/// Surfaces that are made by formula, for scenes that need no files. Adding one: its name here and
/// its case in make_shape().
enum class BasicShape { Sphere, Box, Plate, Cylinder, Cone, Torus, Blob };

/// The shape, with its longest side about 2 m long, around the origin.
///
/// Sphere, cylinder, cone and box are closed; the plate is a square in the plane of x and y; the
/// torus lies in that plane; the blob is a closed surface of smooth bumps, always the same.
///
/// cells     of the grid that is bent into the shape, along each side; even
/// returns   2 cells^2 triangles at most, none without area; normals are left out
core::TriangleMesh make_shape(BasicShape shape, int cells);

}  // namespace apps

template <>
struct core::EnumNames<apps::BasicShape> {
    static constexpr auto value = names_from_zero<apps::BasicShape>(
        "sphere", "box", "plate", "cylinder", "cone", "torus", "blob");
};
