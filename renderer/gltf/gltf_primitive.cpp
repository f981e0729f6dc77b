// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf_primitive.h"

#include "renderer/core/error.h"

#include <fmt/core.h>
#include <tiny_gltf.h>

#include <algorithm>

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

constexpr std::uint32_t kUnused = ~0U;

/// What `read` makes of an accessor, once.
template <class Elements, class Read>
const Elements& read_once(std::map<int, Elements>& known, int accessor, const Read& read) {
    const auto found = known.find(accessor);
    return found != known.end() ? found->second
                                : known.emplace(accessor, read(accessor)).first->second;
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
    const std::vector<core::Vec3>& positions =
        read_once(positions_, position->second, [&](int accessor) {
            return read_positions(document_, accessor);
        });
    const std::vector<core::Vec2>* const uv = uv_of(source, where, positions.size());

    std::vector<std::uint32_t> indices;
    if (source.indices >= 0) {
        indices = read_indices(document_, source.indices, positions.size());
    }
    const std::size_t num_corners = source.indices >= 0 ? indices.size() : positions.size();
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
    take_vertices(positions, uv, primitive);
    return primitive;
}

/// Takes the vertices in use, in their order: primitives often share one long list.
void PrimitiveReader::take_vertices(const std::vector<core::Vec3>& positions,
                                    const std::vector<core::Vec2>* uv,
                                    Primitive& primitive) {
    if (renumbered_.size() < positions.size()) renumbered_.resize(positions.size(), kUnused);
    std::vector<std::uint32_t> used;
    for (const Triangle& triangle : primitive.triangles) {
        for (const std::uint32_t vertex : triangle) {
            if (renumbered_[vertex] == kUnused) used.push_back(vertex);
            renumbered_[vertex] = 0;
        }
    }
    std::sort(used.begin(), used.end());
    for (std::uint32_t i = 0; i < used.size(); ++i) {
        primitive.positions.push_back(positions[used[i]]);
        if (uv) primitive.uv.push_back((*uv)[used[i]]);
        renumbered_[used[i]] = i;
    }
    for (Triangle& triangle : primitive.triangles) {
        for (std::uint32_t& vertex : triangle) vertex = renumbered_[vertex];
    }
    for (const std::uint32_t vertex : used) renumbered_[vertex] = kUnused;
}

const std::vector<core::Vec2>* PrimitiveReader::uv_of(const tinygltf::Primitive& source,
                                                      const std::string& where,
                                                      std::size_t num_positions) {
    const LoadedMaterial& loaded = materials_.read(source.material);
    const std::string name = fmt::format("TEXCOORD_{}", loaded.texture_coordinate_set);
    const auto attribute = source.attributes.find(name);
    if (attribute == source.attributes.end()) {
        if (!loaded.material.albedo_texture) return nullptr;
        throw core::Error(where, "has no " + name, "its textured material needs it");
    }
    const std::vector<core::Vec2>& uv = read_once(uv_, attribute->second, [&](int accessor) {
        return read_texture_coordinates(document_, accessor);
    });
    if (uv.size() != num_positions) {
        throw core::Error(
            where,
            fmt::format("has {} positions and {} texture coordinates", num_positions, uv.size()),
            "must be as many");
    }
    return &uv;
}

PrimitiveReader::Size PrimitiveReader::claimed_size(int mesh_index) const {
    const tinygltf::Model& model = *document_.model;
    const auto count_of = [&](int accessor) {
        return static_cast<double>(checked_count(document_, accessor));
    };
    Size size;
    for (const auto& source : model.meshes[static_cast<std::size_t>(mesh_index)].primitives) {
        const auto position = source.attributes.find("POSITION");
        if (position == source.attributes.end()) continue;
        const double positions = count_of(position->second);
        const double corners = source.indices >= 0 ? count_of(source.indices) : positions;
        const double triangles = source.mode == TINYGLTF_MODE_TRIANGLES ? corners / 3.0 : corners;
        size.triangles += triangles;
        size.bytes += std::min(positions, corners) * (sizeof(core::Vec3) + sizeof(core::Vec2)) +
                      triangles * sizeof(Triangle);
    }
    return size;
}

}  // namespace renderer
