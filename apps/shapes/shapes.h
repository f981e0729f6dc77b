// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"
#include "renderer/core/settings.h"

namespace apps {

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
