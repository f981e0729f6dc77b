// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"

#include <array>
#include <string>
#include <vector>

namespace core {

/// A material as the file gives it.
struct FileMaterial {
    std::string name;
    std::array<double, 3> colour{1.0, 1.0, 1.0};  ///< diffuse, linear; white where none is given
    double metallic = 0.0;
    double roughness = 1.0;
    std::vector<std::string> warnings;  ///< what the file says of it that is not modelled
};

/// Triangles of one name and one material; they begin where those of the part before end.
struct FilePart {
    std::string name;  ///< of the object, group or solid; may be empty
    std::size_t material = 0;
    std::size_t end = 0;  ///< the triangle behind its last
};

/// A mesh file as it stands, in its own units and axes.
struct FileMesh {
    TriangleMesh mesh;                       ///< finite vertices; all triangles of all parts
    std::vector<FilePart> parts;             ///< in the order of the file
    std::vector<FileMaterial> materials{1};  ///< the first is that of parts which give none
    std::vector<std::string> warnings;       ///< what of the file is not modelled
};

inline constexpr const char* kColoursNotModelled = "the colours of its vertices are not modelled";

}  // namespace core
