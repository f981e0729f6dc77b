// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"

#include <span>
#include <string>

namespace core {

/// Polygons one behind the other, whose corners are numbers of vertices.
struct Polygons {
    std::vector<std::uint32_t> corners;
    std::vector<std::size_t> ends;  ///< of each, in `corners`
};

/// Adds the triangles of polygons to the mesh of their vertices.
///
/// A polygon without a dent becomes a fan about its first corner, one of four corners with a dent
/// a fan about that; all others lose one ear after the other. Less than three corners have no
/// triangles.
///
/// path     names the file in messages
/// begin    the first polygon to add
/// end      the polygon behind the last
/// throws   Error when a corner is no vertex, or a polygon with dents too large
/// source   [ORourke1998]
void add_triangles(const std::string& path,
                   const Polygons& polygons,
                   std::size_t begin,
                   std::size_t end,
                   TriangleMesh& mesh);

}  // namespace core
