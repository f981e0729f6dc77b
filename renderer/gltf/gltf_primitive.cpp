// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf_primitive.h"

#include "renderer/core/error.h"
#include "renderer/gltf/gltf_features.h"

#include <fmt/core.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <functional>

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

template <class T>
std::vector<T> picked(const std::vector<T>& all, const std::vector<std::uint32_t>& numbers) {
    std::vector<T> result;
    result.reserve(numbers.size());
    for (const std::uint32_t number : numbers) result.push_back(all[number]);
    return result;
}

/// Throws Error unless there are values of all vertices that are used, in order.
template <class T>
void require_vertices(const std::vector<T>& values,
                      const std::vector<std::uint32_t>& used,
                      const std::string& where,
                      const std::string& name) {
    if (used.empty() || used.back() < values.size()) return;
    throw core::Error(where,
                      fmt::format("has {} {} and a vertex {}", values.size(), name, used.back()),
                      "must have one for each vertex");
}

}  // namespace

const std::vector<Primitive>& PrimitiveReader::read(int mesh_index) {
    const auto found = loaded_.find(mesh_index);
    if (found != loaded_.end()) return found->second;
    std::vector<Primitive> primitives;
    const auto& sources = document_.model->meshes[static_cast<std::size_t>(mesh_index)].primitives;
    const core::Json& json = document_.json["meshes"][static_cast<std::size_t>(mesh_index)];
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const std::string where =
            document_.where(fmt::format("meshes[{}].primitives[{}]", mesh_index, i));
        if (sources[i].mode > TINYGLTF_MODE_TRIANGLE_FAN) {
            throw core::Error(
                where, fmt::format("found mode {}", sources[i].mode), "must be 0 to 6");
        }
        std::vector<std::string> warnings;
        note_features(GltfPart::Primitive,
                      json["primitives"][i],
                      document_.json,
                      "mesh " + json.value("name", std::to_string(mesh_index)),
                      where,
                      warnings);
        const bool is_of_triangles = sources[i].mode >= TINYGLTF_MODE_TRIANGLES;
        primitives.push_back(is_of_triangles ? read_primitive(sources[i], where) : Primitive{});
        primitives.back().warnings = std::move(warnings);
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
    primitive.triangles = corners_of(source, where, positions.size());
    const std::vector<std::uint32_t> used = renumber(positions.size(), primitive.triangles);
    primitive.positions = picked(positions, used);
    if (const auto* uv = uv_of(source, where, positions.size())) {
        const Eigen::Affine2d& transform = materials_.read(source.material).uv_transform;
        primitive.uv = picked(*uv, used);
        for (core::Vec2& place : primitive.uv) place = transform * place;
    }
    read_colours_of(source, where, used, primitive);
    read_morphs(source, where, used, primitive);
    read_influences(source, where, used, primitive);
    return primitive;
}

std::vector<Triangle> PrimitiveReader::corners_of(const tinygltf::Primitive& source,
                                                  const std::string& where,
                                                  std::size_t num_positions) const {
    std::vector<std::uint32_t> indices;
    if (source.indices >= 0) indices = read_indices(document_, source.indices, num_positions);
    const std::size_t num_corners = source.indices >= 0 ? indices.size() : num_positions;
    if (num_corners < 3 || (source.mode == TINYGLTF_MODE_TRIANGLES && num_corners % 3 != 0)) {
        throw core::Error(where,
                          fmt::format("has {} corners", num_corners),
                          "lists of triangles need a multiple of 3, strips and fans at least 3");
    }
    std::vector<Triangle> triangles =
        triangle_corners(source.mode, static_cast<std::uint32_t>(num_corners));
    if (source.indices < 0) return triangles;
    for (Triangle& triangle : triangles) {
        for (std::uint32_t& corner : triangle) corner = indices[corner];
    }
    return triangles;
}

/// Numbers the vertices that triangles use anew, in their order: primitives often share one long
/// list. Returns their numbers in that.
std::vector<std::uint32_t> PrimitiveReader::renumber(std::size_t num_positions,
                                                     std::vector<Triangle>& triangles) {
    if (renumbered_.size() < num_positions) renumbered_.resize(num_positions, kUnused);
    std::vector<std::uint32_t> used;
    for (const Triangle& triangle : triangles) {
        for (const std::uint32_t vertex : triangle) {
            if (renumbered_[vertex] == kUnused) used.push_back(vertex);
            renumbered_[vertex] = 0;
        }
    }
    std::sort(used.begin(), used.end());
    for (std::uint32_t i = 0; i < used.size(); ++i) renumbered_[used[i]] = i;
    for (Triangle& triangle : triangles) {
        for (std::uint32_t& vertex : triangle) vertex = renumbered_[vertex];
    }
    for (const std::uint32_t vertex : used) renumbered_[vertex] = kUnused;
    return used;
}

/// COLOR_0 multiplies the base colour. Where it is the same everywhere, the albedo stays one.
void PrimitiveReader::read_colours_of(const tinygltf::Primitive& source,
                                      const std::string& where,
                                      const std::vector<std::uint32_t>& used,
                                      Primitive& primitive) const {
    const auto attribute = source.attributes.find("COLOR_0");
    if (attribute == source.attributes.end()) return;
    const std::vector<core::Vec3> colours = read_colours(document_, attribute->second);
    require_vertices(colours, used, where, "COLOR_0");
    const core::Vec3 base(materials_.read(source.material).colour.data());
    for (const core::Vec3& colour : picked(colours, used)) {
        const double coloured = base.dot(colour.cwiseMax(0.0).cwiseMin(1.0));
        primitive.vertex_albedo.push_back(base.sum() > 0.0 ? coloured / base.sum() : 0.0);
    }
    const auto& factors = primitive.vertex_albedo;
    if (std::adjacent_find(factors.begin(), factors.end(), std::not_equal_to<>()) ==
        factors.end()) {
        primitive.albedo = factors.front();
        primitive.vertex_albedo.clear();
    }
}

void PrimitiveReader::read_morphs(const tinygltf::Primitive& source,
                                  const std::string& where,
                                  const std::vector<std::uint32_t>& used,
                                  Primitive& primitive) const {
    for (const auto& target : source.targets) {
        std::vector<core::Vec3>& ways = primitive.morphs.emplace_back();
        const auto attribute = target.find("POSITION");
        if (attribute == target.end()) continue;
        const std::vector<core::Vec3> all = read_positions(document_, attribute->second);
        require_vertices(all, used, where, "ways of a morph target");
        ways = picked(all, used);
    }
}

void PrimitiveReader::read_influences(const tinygltf::Primitive& source,
                                      const std::string& where,
                                      const std::vector<std::uint32_t>& used,
                                      Primitive& primitive) const {
    for (int set = 0;; ++set) {
        const auto joints = source.attributes.find(fmt::format("JOINTS_{}", set));
        const auto weights = source.attributes.find(fmt::format("WEIGHTS_{}", set));
        if (joints == source.attributes.end() || weights == source.attributes.end()) return;
        const auto all_joints = read_vectors4(document_, joints->second);
        const auto all_weights = read_vectors4(document_, weights->second);
        require_vertices(all_joints, used, where, joints->first);
        require_vertices(all_weights, used, where, weights->first);
        std::vector<Influences>& of_vertices = primitive.influences.emplace_back();
        for (const std::uint32_t vertex : used) {
            Influences& influences = of_vertices.emplace_back();
            for (int i = 0; i < 4; ++i) {
                influences[static_cast<std::size_t>(i)] = {
                    static_cast<std::uint32_t>(std::max(0.0, all_joints[vertex][i])),
                    std::max(0.0, all_weights[vertex][i])};
            }
        }
    }
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
        const double per_vertex = sizeof(core::Vec3) + sizeof(core::Vec2) + sizeof(double) +
                                  sizeof(core::Vec3) * static_cast<double>(source.targets.size());
        size.bytes += std::min(positions, corners) * per_vertex + triangles * sizeof(Triangle);
    }
    return size;
}

}  // namespace renderer
