// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf_primitive.h"

#include "renderer/core/error.h"
#include "renderer/gltf/gltf_accessor.h"

#include <fmt/core.h>
#include <tiny_gltf.h>

namespace renderer {
namespace {

/// Corner numbers of the triangles of a list, strip or fan of `n` corners (source [glTF2] 3.7.2.1).
std::vector<Triangle> triangle_corners(int mode, std::uint32_t n) {
    std::vector<Triangle> corners;
    if (n < 3) return corners;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        for (std::uint32_t i = 0; i < n; i += 3) corners.push_back({i, i + 1, i + 2});
        return corners;
    }
    for (std::uint32_t i = 0; i + 2 < n; ++i) {
        if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            corners.push_back({i, i + 1 + i % 2, i + 2 - i % 2});
        } else {
            corners.push_back({i + 1, i + 2, 0});
        }
    }
    return corners;
}

/// Keeps the vertices in use: primitives often share one long list.
void drop_unused_vertices(Primitive& primitive) {
    constexpr std::uint32_t kUnused = ~0u;
    std::vector<std::uint32_t> renumbered(primitive.positions.size(), kUnused);
    for (const Triangle& triangle : primitive.triangles) {
        for (const std::uint32_t vertex : triangle) renumbered[vertex] = 0;
    }
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < renumbered.size(); ++i) {
        if (renumbered[i] == kUnused) continue;
        primitive.positions[next] = primitive.positions[i];
        if (!primitive.uv.empty()) primitive.uv[next] = primitive.uv[i];
        renumbered[i] = next++;
    }
    primitive.positions.resize(next);
    if (!primitive.uv.empty()) primitive.uv.resize(next);
    for (Triangle& triangle : primitive.triangles) {
        for (std::uint32_t& vertex : triangle) vertex = renumbered[vertex];
    }
}

}  // namespace

const std::vector<Primitive>& PrimitiveReader::read(int mesh_index) {
    const auto found = loaded_.find(mesh_index);
    if (found != loaded_.end()) return found->second;
    std::vector<Primitive> primitives;
    const auto& sources = document_.model->meshes[static_cast<std::size_t>(mesh_index)].primitives;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const std::string where =
            document_.where(fmt::format("meshes[{}].primitives[{}]", mesh_index, i));
        if (sources[i].mode > TINYGLTF_MODE_TRIANGLE_FAN) {
            throw core::Error(
                where, fmt::format("found mode {}", sources[i].mode), "must be 0 to 6");
        }
        if (sources[i].mode < TINYGLTF_MODE_TRIANGLES) continue;
        primitives.push_back(read_primitive(sources[i], where));
    }
    return loaded_.emplace(mesh_index, std::move(primitives)).first->second;
}

Primitive PrimitiveReader::read_primitive(const tinygltf::Primitive& source,
                                          const std::string& where) {
    const auto position = source.attributes.find("POSITION");
    if (position == source.attributes.end()) {
        throw core::Error(where, "has no POSITION", "triangles need positions");
    }
    Primitive primitive;
    primitive.material = source.material;
    primitive.positions = read_positions(document_, position->second);
    read_uv(source, where, primitive);

    std::vector<std::uint32_t> indices;
    if (source.indices >= 0) {
        indices = read_indices(document_, source.indices, primitive.positions.size());
    }
    const std::size_t num_corners =
        source.indices >= 0 ? indices.size() : primitive.positions.size();
    if (num_corners < 3 || (source.mode == TINYGLTF_MODE_TRIANGLES && num_corners % 3 != 0)) {
        throw core::Error(where,
                          fmt::format("has {} corners", num_corners),
                          "lists of triangles need a multiple of 3, strips and fans at least 3");
    }
    primitive.triangles = triangle_corners(source.mode, static_cast<std::uint32_t>(num_corners));
    if (source.indices >= 0) {
        for (Triangle& triangle : primitive.triangles) {
            for (std::uint32_t& corner : triangle) corner = indices[corner];
        }
    }
    drop_unused_vertices(primitive);
    return primitive;
}

void PrimitiveReader::read_uv(const tinygltf::Primitive& source,
                              const std::string& where,
                              Primitive& primitive) {
    const LoadedMaterial& loaded = materials_.read(source.material);
    const std::string name = fmt::format("TEXCOORD_{}", loaded.texture_coordinate_set);
    const auto attribute = source.attributes.find(name);
    if (attribute == source.attributes.end()) {
        if (!loaded.material.albedo_texture) return;
        throw core::Error(where, "has no " + name, "its textured material needs it");
    }
    primitive.uv = read_texture_coordinates(document_, attribute->second);
    if (primitive.uv.size() != primitive.positions.size()) {
        throw core::Error(where,
                          fmt::format("has {} positions and {} texture coordinates",
                                      primitive.positions.size(),
                                      primitive.uv.size()),
                          "must be as many");
    }
}

}  // namespace renderer
