// SPDX-License-Identifier: MIT
#include "renderer/core/mesh_formats/mesh_formats.h"

#include "renderer/core/error.h"
#include "renderer/core/file_suffix.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/nearest_name.h"
#include "renderer/core/system/process.h"

#include <filesystem>

namespace core {

const MeshFormat* mesh_format(const std::string& path) {
    const std::string suffix = file_suffix(path);
    for (const MeshFormat* format : {&kObj, &kPly, &kStl}) {
        if (suffix == format->suffix) return format;
    }
    return nullptr;
}

void throw_damaged(const std::string& path, const std::string& found) {
    throw Error(
        path, found, std::string("must be a complete ") + mesh_format(path)->name + " file");
}

FileMesh read_mesh_file(const std::string& path) {
    const MeshFormat* const format = mesh_format(path);
    if (format == nullptr)
        throw Error(path, "is no mesh file", "must be a .obj, .ply or .stl file");
    const MappedFile file(path, std::string("must be a readable ") + format->name + " file");
    file.require_stored();
    // A line of eight characters may become a triangle and its fraction of the vertices.
    constexpr std::size_t kLargestGrowth = 8;
    require_memory(kLargestGrowth * file.bytes().size(), path);
    std::string_view text = file.bytes();
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark of UTF-8
    FileMesh read = format->parse(path, text);
    for (const Vec3& vertex : read.mesh.vertices) {
        if (vertex.allFinite()) continue;
        throw Error(path, "has a vertex that is not finite", "must have finite ones");
    }
    return read;
}

}  // namespace core
