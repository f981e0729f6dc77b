// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace renderer {

/// A material as the file states it.
struct FileMaterial {
    std::string name;
    std::array<double, 3> colour{1.0, 1.0, 1.0};  ///< diffuse, linear; white where none is stated
    double metallic = 0.0;
    double roughness = 1.0;
    std::vector<std::string> warnings;  ///< what the file says of it that is not modelled
};

/// Triangles of one material, in the file's units and axes. Corners at one place are one vertex.
struct FileMesh {
    std::string name;  ///< of the object, group or solid; may be empty
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::size_t material = 0;
};

/// A mesh file as assimp reads it.
struct AssimpFile {
    std::vector<FileMesh> meshes;  ///< each with at least one triangle
    std::vector<FileMaterial> materials;
    std::vector<std::string> warnings;  ///< of the file as a whole
};

/// Reads a Wavefront OBJ, PLY or STL file in a sandboxed process, since some damaged files crash
/// assimp; of an OBJ file also the material files (MTL) beside it. Polygons become triangles;
/// points and lines are left out.
///
/// suffix   .obj, .ply or .stl: the format
/// throws   core::Error when the file is damaged, core::Failure when it does not fit in memory
AssimpFile read_with_assimp(const std::string& path, const std::string& suffix);

}  // namespace renderer
