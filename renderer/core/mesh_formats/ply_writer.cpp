// SPDX-License-Identifier: MIT
#include "renderer/core/mesh_formats/ply_writer.h"

#include "renderer/core/error.h"
#include "renderer/core/precision.h"
#include "renderer/core/system/output_file.h"

#include <algorithm>
#include <bit>
#include <fstream>
#include <span>

namespace core {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY bodies are written as is");

void write_body(const std::string& path,
                const std::vector<Vec3>& positions,
                const std::vector<Vec3>& normals,
                std::span<const std::array<std::uint32_t, 3>> triangles) {
    OutputFile output(path);
    std::ofstream file(output.temporary(), std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\ncomment metres in the world\n";
    file << "element vertex " << positions.size() << "\n";
    const bool is_far = std::ranges::any_of(positions, needs_double);
    for (const char* name : {"x", "y", "z"}) {
        file << "property " << (is_far ? "double " : "float ") << name << "\n";
    }
    for (const char* name : {"nx", "ny", "nz"}) {
        if (!normals.empty()) file << "property float " << name << "\n";
    }
    if (!triangles.empty()) {
        file << "element face " << triangles.size()
             << "\nproperty list uchar uint vertex_indices\n";
    }
    file << "end_header\n";
    const auto write_vector = [&](const Vec3& vector) {
        const Eigen::Vector3f single = vector.cast<float>();
        file.write(reinterpret_cast<const char*>(single.data()), sizeof(single));
    };
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (is_far) {
            file.write(reinterpret_cast<const char*>(positions[i].data()), sizeof(positions[i]));
        } else {
            write_vector(positions[i]);
        }
        if (!normals.empty()) write_vector(normals[i]);
    }
    for (const auto& triangle : triangles) {
        file.put(3);
        file.write(reinterpret_cast<const char*>(triangle.data()), sizeof(triangle));
    }
    file.close();
    if (!file) throw Failure(path, "cannot be written (disk full?)");
    output.commit();
}

}  // namespace

void write_ply(const std::string& path, const PointCloud& points) {
    write_body(path, points.positions, points.normals, {});
}

void write_ply(const std::string& path, const TriangleMesh& mesh) {
    write_body(path, mesh.vertices, mesh.normals, mesh.triangles);
}

}  // namespace core
