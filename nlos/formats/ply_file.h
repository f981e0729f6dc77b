// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"

#include <string>

namespace nlos {

/// Reads the vertices, normals and faces of a PLY file: ASCII or binary little endian, any scalar
/// types; polygons become fans of triangles, everything else is skipped.
///
/// returns   a mesh; without triangles when the file holds a point cloud, without normals when the
///           file has none
/// throws    core::Error when the file is damaged, or an index or number out of range
/// source    [Turk1994]
core::TriangleMesh read_ply(const std::string& path);

/// Write points or a mesh as binary little endian PLY in single precision; whole or not at all.
/// throw    core::Error for a bad target, core::Failure when writing fails
void write_ply(const std::string& path, const core::PointCloud& points);
void write_ply(const std::string& path, const core::TriangleMesh& mesh);

}  // namespace nlos
