// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_file.h"

#include <span>
#include <string>
#include <vector>

namespace renderer {

/// What a feature of a glTF file is a feature of.
enum class GltfPart { File, Node, Primitive, Material, Texture };

/// What becomes of it.
enum class GltfHandling {
    Applied,  ///< the scene is as the file says
    Refused,  ///< the file is not read
    Named,    ///< a warning says that it is left out
    Beside    ///< changes neither where surfaces are nor how much light they return
};

/// A feature of glTF 2.0 or an extension of it.
struct GltfFeature {
    const char* name;  ///< an extension's own
    GltfPart part;
    GltfHandling handling;
    const char* says = "";  ///< what the warning says, or a refusal asks for
    /// Whether a part uses it, by the part's JSON and that of the file; null: an extension, which
    /// is used where `extensions` holds it.
    bool (*is_used)(const core::Json& part, const core::Json& file) = nullptr;
};

/// All that change geometry or reflectance.
std::span<const GltfFeature> gltf_features();

/// Goes through the features that a part of a file uses, with extensions that are none of these.
///
/// name       of the part in warnings, such as "material steel"; empty for the file itself
/// warnings   gets a line for each that is left out, unless it has that already
/// throws     core::Error, which names `where`, for one that is refused
void note_features(GltfPart part,
                   const core::Json& json,
                   const core::Json& file,
                   const std::string& name,
                   const std::string& where,
                   std::vector<std::string>& warnings);

/// Throws core::Error for an extension without which a file cannot be shown and that is not
/// applied.
void check_required_extensions(const core::Json& file, const std::string& path);

}  // namespace renderer
