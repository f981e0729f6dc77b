// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_file.h"
#include "renderer/core/types.h"

#include <memory>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace renderer {

/// A glTF file as read: its JSON, and its buffers and images through tinygltf.
///
/// Every index in it exists, every number has the type glTF wants and every buffer view lies inside
/// its buffer; images hold their undecoded bytes.
struct GltfDocument {
    std::string path;
    core::Json json;
    std::shared_ptr<const tinygltf::Model> model;
    std::vector<std::string> warnings{};  ///< what the file as a whole says that is not modelled

    /// `file: part`, the place that an error message names.
    std::string where(const std::string& part) const { return path + ": " + part; }
};

/// Reads a .gltf or .glb file, distinguished by content, and checks it.
/// Throws core::Error naming the file and the offending part.
GltfDocument read_gltf_document(const std::string& path);

/// Throws core::Error unless indices, types and sizes in a glTF's JSON are what [glTF2] allows.
///
/// json   the root object
/// path   the file that messages name
void check_gltf_json(const core::Json& json, const std::string& path);

/// How many elements an accessor has; none of them has been looked at.
/// Throws core::Error when they are not in its buffer view, or, without one, beyond reason.
std::size_t checked_count(const GltfDocument& document, int accessor);

/// Vertex positions: floats, or bytes and shorts as KHR_mesh_quantization allows, sparse or not.
///
/// document   a file that read_gltf_document has checked
/// accessor   an existing index
/// returns    one point per element, node coordinates, finite
/// throws     core::Error when the type is another, the data end early or a value is not finite
/// source     [glTF2]
std::vector<core::Vec3> read_positions(const GltfDocument& document, int accessor);

/// Texture coordinates; as read_positions, with two components.
std::vector<core::Vec2> read_texture_coordinates(const GltfDocument& document, int accessor);

/// Vertex colours, linear: as read_positions, of three components or of four, the last left out.
std::vector<core::Vec3> read_colours(const GltfDocument& document, int accessor);

/// Quaternions, joints and their weights; as read_positions, with four components.
std::vector<Eigen::Vector4d> read_vectors4(const GltfDocument& document, int accessor);

/// Matrices of floats.
std::vector<Eigen::Matrix4d> read_matrices(const GltfDocument& document, int accessor);

/// Vertex indices: unsigned bytes, shorts or ints, sparse or not.
///
/// num_vertices   what every index must be below
/// throws         core::Error when the type is another, the data end early or an index is too large
std::vector<std::uint32_t> read_indices(const GltfDocument& document,
                                        int accessor,
                                        std::size_t num_vertices);

}  // namespace renderer
