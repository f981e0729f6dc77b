// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"

#include <fmt/core.h>

#include <cstring>
#include <string>

namespace mesh_file_test {

/// Two walls of a corner and a roof over it, with shared vertices; coordinates are floats.
inline core::TriangleMesh example_mesh() {
    core::TriangleMesh mesh;
    mesh.vertices = {{-0.25, -0.125, 0.5},
                     {0.25, -0.125, 0.625},
                     {0.25, 0.25, 0.625},
                     {-0.25, 0.25, 0.5},
                     {0.0, 0.375, 0.75}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {3, 2, 4}};
    return mesh;
}

inline std::string obj_text(const core::TriangleMesh& mesh) {
    std::string text;
    for (const auto& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
    for (const auto& [a, b, c] : mesh.triangles) {
        text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
    }
    return text;
}

template <class T>
void append_bytes(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// A PLY file, in text or binary little endian.
inline std::string ply_bytes(const core::TriangleMesh& mesh, bool is_binary) {
    std::string bytes = fmt::format(
        "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
        "z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        is_binary ? "binary_little_endian" : "ascii",
        mesh.vertices.size(),
        mesh.triangles.size());
    for (const auto& v : mesh.vertices) {
        if (!is_binary) bytes += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
        for (int i = 0; i < 3 && is_binary; ++i) append_bytes(bytes, static_cast<float>(v[i]));
    }
    for (const auto& triangle : mesh.triangles) {
        if (!is_binary) {
            bytes += fmt::format("3 {} {} {}\n", triangle[0], triangle[1], triangle[2]);
            continue;
        }
        append_bytes(bytes, std::uint8_t{3});
        for (const std::uint32_t corner : triangle) append_bytes(bytes, corner);
    }
    return bytes;
}

/// An STL file, in text or binary.
inline std::string stl_bytes(const core::TriangleMesh& mesh, bool is_binary) {
    std::string bytes = is_binary ? std::string(80, ' ') : "solid roof\n";
    if (is_binary) append_bytes(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& triangle : mesh.triangles) {
        if (is_binary) bytes.append(12, '\0');  // a normal, which readers compute anew
        if (!is_binary) bytes += "facet normal 0 0 0\nouter loop\n";
        for (const std::uint32_t corner : triangle) {
            const core::Vec3& v = mesh.vertices[corner];
            if (!is_binary) bytes += fmt::format("vertex {} {} {}\n", v.x(), v.y(), v.z());
            for (int i = 0; i < 3 && is_binary; ++i) append_bytes(bytes, static_cast<float>(v[i]));
        }
        if (is_binary) append_bytes(bytes, std::uint16_t{0});
        if (!is_binary) bytes += "endloop\nendfacet\n";
    }
    return is_binary ? bytes : bytes + "endsolid roof\n";
}

}  // namespace mesh_file_test
