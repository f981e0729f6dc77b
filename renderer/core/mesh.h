// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace core {

/// An indexed triangle mesh.
struct TriangleMesh {
    std::vector<Vec3> vertices;  ///< [m]
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vec3> normals;  ///< per vertex, unit; empty when unknown
};

/// Adds the vertices and triangles of a mesh to another, behind its own; normals are left out.
void append_mesh(const TriangleMesh& mesh, TriangleMesh& target);

/// Area vector of a triangle: half the cross product of its edges; its norm is the area [m^2].
inline Vec3 triangle_area_vector(const Vec3& a, const Vec3& b, const Vec3& c) {
    return 0.5 * (b - a).cross(c - a);
}

/// False for triangles, given by two edges from one corner, that are points or lines up to
/// rounding.
bool has_area(const Vec3& ab, const Vec3& ac);

/// Points with normals, in no order.
struct PointCloud {
    std::vector<Vec3> positions;  ///< [m, world]
    std::vector<Vec3> normals;    ///< unit; empty when unknown
};

/// Draws `count` points uniformly by area, with the normals of their facets.
/// Throws Error when the mesh has no area.
PointCloud sample_surface(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed);

}  // namespace core
