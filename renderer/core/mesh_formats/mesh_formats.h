// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh_formats/file_mesh.h"

#include <string>
#include <string_view>

namespace core {

/// A format of mesh files: its row in the list of mesh_formats.cpp.
///
/// Readers take nothing in a file for granted: what they allocate is bounded by its size, and every
/// number is checked before it is used.
struct MeshFormat {
    const char* name;
    const char* suffix;  ///< of its files, in lower case
    /// The file's triangles. Throws Error, naming `path`, when the text is damaged.
    FileMesh (*parse)(const std::string& path, std::string_view text);
};

extern const MeshFormat kObj;
extern const MeshFormat kPly;
extern const MeshFormat kStl;

/// The format that a file's suffix names, in any case; null when it is none of these.
const MeshFormat* mesh_format(const std::string& path);

/// Throws Error for a file that is not what its suffix says.
[[noreturn]] void throw_damaged(const std::string& path, const std::string& found);

/// Reads a mesh file of the format that its suffix names; of an OBJ file also the material files
/// (MTL) beside it.
///
/// throws   Error when the file is in no such format, cannot be read or is damaged, Failure when it
///          does not fit in memory
FileMesh read_mesh_file(const std::string& path);

}  // namespace core
