// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"

#include <string>

namespace core {

/// Write points or a mesh as binary little endian PLY in single precision; whole or not at all.
/// throw    Error for a bad target, Failure when writing fails
void write_ply(const std::string& path, const PointCloud& points);
void write_ply(const std::string& path, const TriangleMesh& mesh);

}  // namespace core
