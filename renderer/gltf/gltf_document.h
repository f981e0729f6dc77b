// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

#include <memory>
#include <string>

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

}  // namespace renderer
