// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh_formats/file_mesh.h"

#include <map>
#include <string>
#include <string_view>

namespace core {

/// The materials of an OBJ file and of its material files, by name.
struct NamedMaterials {
    std::vector<FileMaterial> list{1};  ///< the first is that of faces before any name
    std::map<std::string, std::size_t, std::less<>> index;

    /// The place of a name in the list; a new one is white.
    std::size_t find_or_add(std::string_view name);
};

/// Reads the materials of a Wavefront MTL file.
/// throws   Error when the file cannot be read or is damaged
/// source   [Wavefront1995]
void read_mtl(const std::string& path, NamedMaterials& materials);

}  // namespace core
