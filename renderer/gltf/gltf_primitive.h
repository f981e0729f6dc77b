// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"
#include "renderer/gltf/gltf_document.h"
#include "renderer/gltf/gltf_material.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tinygltf {
struct Primitive;
}

namespace renderer {

using Triangle = std::array<std::uint32_t, 3>;

/// A joint that a vertex belongs to, and how much.
struct Influence {
    std::uint32_t joint = 0;  ///< in the list of the skin
    double weight = 0.0;
};
using Influences = std::array<Influence, 4>;

/// Triangles of one material in node coordinates, with the vertices that they use.
struct Primitive {
    std::vector<core::Vec3> positions;
    std::vector<core::Vec2> uv;  ///< per vertex; empty when there are none
    std::vector<Triangle> triangles;
    int material = -1;                                ///< -1: none
    double albedo = 1.0;                              ///< factor of the material's
    std::vector<double> vertex_albedo;                ///< factors per vertex; empty when all are 1
    std::vector<std::vector<core::Vec3>> morphs;      ///< per target, ways of vertices; or empty
    std::vector<std::vector<Influences>> influences;  ///< per set, of vertices
    std::vector<std::string> warnings;                ///< what of it is not modelled
};

/// Reads meshes, each once.
class PrimitiveReader {
 public:
    PrimitiveReader(const GltfDocument& document, MaterialReader& materials)
        : document_(document), materials_(materials) {}

    /// The triangles of a mesh: lists, strips and fans; of points and lines none.
    ///
    /// mesh_index   an existing mesh
    /// throws       core::Error naming the part whose data are wrong
    const std::vector<Primitive>& read(int mesh_index);

    /// At most how many triangles read() will give by what the file says of its accessors, and how
    /// many bytes they and their vertices take. Throws core::Error for claims that are not stored.
    struct Size {
        double triangles = 0.0;
        double bytes = 0.0;
    };
    Size claimed_size(int mesh_index) const;

 private:
    Primitive read_primitive(const tinygltf::Primitive& source, const std::string& where);
    std::vector<Triangle> corners_of(const tinygltf::Primitive& source,
                                     const std::string& where,
                                     std::size_t num_positions) const;
    const std::vector<core::Vec2>* uv_of(const tinygltf::Primitive& source,
                                         const std::string& where,
                                         std::size_t num_positions);
    void read_colours_of(const tinygltf::Primitive& source,
                         const std::string& where,
                         const std::vector<std::uint32_t>& used,
                         Primitive& primitive) const;
    void read_morphs(const tinygltf::Primitive& source,
                     const std::string& where,
                     const std::vector<std::uint32_t>& used,
                     Primitive& primitive) const;
    void read_influences(const tinygltf::Primitive& source,
                         const std::string& where,
                         const std::vector<std::uint32_t>& used,
                         Primitive& primitive) const;
    std::vector<std::uint32_t> renumber(std::size_t num_positions,
                                        std::vector<Triangle>& triangles);

    const GltfDocument& document_;
    MaterialReader& materials_;
    std::map<int, std::vector<Primitive>> loaded_;
    std::map<int, std::vector<core::Vec3>> positions_;  ///< by accessor: primitives share them
    std::map<int, std::vector<core::Vec2>> uv_;
    std::vector<std::uint32_t> renumbered_;  ///< for renumber()
};

}  // namespace renderer
