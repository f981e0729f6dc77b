// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf_features.h"

#include "renderer/core/error.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace renderer {
namespace {

using core::Json;

// The value at a path of keys below a part; null where there is none.
template <class... Keys>
Json below(const Json& part, const Keys&... keys) {
    const Json* at = &part;
    for (const char* key : {keys...}) {
        const auto found = at->is_object() ? at->find(key) : at->end();
        if (!at->is_object() || found == at->end()) return {};
        at = &*found;
    }
    return *at;
}

// The entry of a list that a part refers to by its number; null where it refers to none.
Json entry(const Json& file, const char* list, const Json& number) {
    if (!number.is_number_unsigned() || !file.contains(list)) return {};
    const auto index = number.get<std::size_t>();
    return index < file[list].size() ? file[list][index] : Json();
}

double factor_of(const Json& material, const char* key) {
    return below(material, "pbrMetallicRoughness", key).is_number()
               ? material["pbrMetallicRoughness"][key].get<double>()
               : 1.0;
}

bool is_partly_metallic(const Json& material, const Json&) {
    const double metallic = factor_of(material, "metallicFactor");
    return metallic > 0.0 && metallic < 1.0;
}

bool is_metal_by_default(const Json& material, const Json&) {
    return below(material, "pbrMetallicRoughness", "metallicFactor").is_null() &&
           below(material, "pbrMetallicRoughness", "roughnessFactor").is_null();
}

bool has_roughness_texture(const Json& material, const Json&) {
    return !below(material, "pbrMetallicRoughness", "metallicRoughnessTexture").is_null();
}

bool has_normal_map(const Json& material, const Json&) {
    return material.contains("normalTexture");
}

bool emits(const Json& material, const Json&) {
    const Json factor = below(material, "emissiveFactor");
    return material.contains("emissiveTexture") ||
           std::any_of(factor.begin(), factor.end(), [](const Json& value) {
               return value.is_number() && value.get<double>() > 0.0;
           });
}

bool is_transparent(const Json& material, const Json&) {
    const Json mode = below(material, "alphaMode");
    return mode == "BLEND" || mode == "MASK";
}

bool is_of_points_or_lines(const Json& primitive, const Json&) {
    constexpr int kTriangles = 4;
    const Json mode = below(primitive, "mode");
    return mode.is_number_integer() && mode.get<int>() < kTriangles;
}

bool morphs_its_looks(const Json& primitive, const Json&) {
    const Json targets = below(primitive, "targets");
    return std::any_of(targets.begin(), targets.end(), [](const Json& target) {
        return target.is_object() && (target.contains("COLOR_0") || target.contains("TEXCOORD_0"));
    });
}

// Fallback data may stand beside compressed ones: accessors of uncompressed primitives.
bool is_draco_alone(const Json& primitive, const Json& file) {
    if (below(primitive, "extensions", "KHR_draco_mesh_compression").is_null()) return false;
    const Json positions = entry(file, "accessors", below(primitive, "attributes", "POSITION"));
    return below(positions, "bufferView").is_null();
}

bool is_meshopt_alone(const Json& file, const Json&) {
    const Json views = below(file, "bufferViews");
    return std::any_of(views.begin(), views.end(), [&](const Json& view) {
        const Json buffer = entry(file, "buffers", below(view, "buffer"));
        return below(buffer, "uri").is_null() &&
               (below(buffer, "extensions", "EXT_meshopt_compression", "fallback") == true ||
                below(buffer, "extensions", "KHR_meshopt_compression", "fallback") == true);
    });
}

bool is_animated(const Json& file, const Json&) {
    return !below(file, "animations").empty();
}

bool wants_nearest_texels(const Json& texture, const Json& file) {
    constexpr int kNearest = 9728;
    const Json source = entry(file, "textures", below(texture, "index"));
    return below(entry(file, "samplers", below(source, "sampler")), "magFilter") == kNearest;
}

constexpr std::array kFeatures{
    // Where surfaces are.
    GltfFeature{"KHR_mesh_quantization", GltfPart::Primitive, GltfHandling::Applied},
    GltfFeature{"EXT_mesh_gpu_instancing", GltfPart::Node, GltfHandling::Applied},
    GltfFeature{"KHR_node_visibility", GltfPart::Node, GltfHandling::Applied},
    GltfFeature{"points and lines",
                GltfPart::Primitive,
                GltfHandling::Named,
                "its points and lines are left out",
                is_of_points_or_lines},
    GltfFeature{"KHR_draco_mesh_compression",
                GltfPart::Primitive,
                GltfHandling::Refused,
                "must be stored without compression (KHR_draco_mesh_compression)",
                is_draco_alone},
    GltfFeature{"EXT_meshopt_compression",
                GltfPart::File,
                GltfHandling::Refused,
                "must be stored without compression (EXT_meshopt_compression)",
                is_meshopt_alone},
    GltfFeature{"animations",
                GltfPart::File,
                GltfHandling::Named,
                "its animations are not played: nodes stand where the file puts them",
                is_animated},
    // How much light they return.
    GltfFeature{"KHR_texture_transform", GltfPart::Texture, GltfHandling::Applied},
    GltfFeature{"morph targets of looks",
                GltfPart::Primitive,
                GltfHandling::Named,
                "its morph targets of colours and texture coordinates are not modelled",
                morphs_its_looks},
    GltfFeature{"metallicFactor",
                GltfPart::Material,
                GltfHandling::Named,
                "a metallicFactor between 0 and 1 is taken as metal",
                is_partly_metallic},
    GltfFeature{"metal by default",
                GltfPart::Material,
                GltfHandling::Named,
                "without metallicFactor and roughnessFactor it is a rough metal by glTF's defaults",
                is_metal_by_default},
    GltfFeature{"metallicRoughnessTexture",
                GltfPart::Material,
                GltfHandling::Named,
                "its metallic-roughness texture is not modelled; the factors count alone",
                has_roughness_texture},
    GltfFeature{"normalTexture",
                GltfPart::Material,
                GltfHandling::Named,
                "its normal map is not modelled",
                has_normal_map},
    GltfFeature{
        "emission", GltfPart::Material, GltfHandling::Named, "its emission is not modelled", emits},
    GltfFeature{"alphaMode",
                GltfPart::Material,
                GltfHandling::Named,
                "its transparency is not modelled: it is opaque",
                is_transparent},
    GltfFeature{"nearest texels",
                GltfPart::Texture,
                GltfHandling::Named,
                "its texture is interpolated where it asks for the nearest texel",
                wants_nearest_texels},
    // Neither.
    GltfFeature{"EXT_instance_features", GltfPart::Node, GltfHandling::Beside},
    GltfFeature{"KHR_audio_emitter", GltfPart::Node, GltfHandling::Beside},
    GltfFeature{"KHR_lights_punctual", GltfPart::Node, GltfHandling::Beside},
    GltfFeature{"KHR_node_hoverability", GltfPart::Node, GltfHandling::Beside},
    GltfFeature{"KHR_node_selectability", GltfPart::Node, GltfHandling::Beside},
    GltfFeature{"KHR_xmp_json_ld", GltfPart::Node, GltfHandling::Beside},
    GltfFeature{"MSFT_lod", GltfPart::Node, GltfHandling::Beside},
    GltfFeature{"CESIUM_primitive_outline", GltfPart::Primitive, GltfHandling::Beside},
    GltfFeature{"EXT_mesh_features", GltfPart::Primitive, GltfHandling::Beside},
    GltfFeature{"EXT_structural_metadata", GltfPart::Primitive, GltfHandling::Beside},
    GltfFeature{"KHR_materials_variants", GltfPart::Primitive, GltfHandling::Beside},
    GltfFeature{"KHR_xmp_json_ld", GltfPart::Material, GltfHandling::Beside},
};

bool is_listed(GltfPart part, const std::string& extension) {
    return std::any_of(kFeatures.begin(), kFeatures.end(), [&](const GltfFeature& row) {
        return row.part == part && row.name == extension;
    });
}

void add_once(const std::string& text, std::vector<std::string>& warnings) {
    if (std::find(warnings.begin(), warnings.end(), text) == warnings.end()) {
        warnings.push_back(text);
    }
}

}  // namespace

std::span<const GltfFeature> gltf_features() {
    return kFeatures;
}

void note_features(GltfPart part,
                   const Json& json,
                   const Json& file,
                   const std::string& name,
                   const std::string& where,
                   std::vector<std::string>& warnings) {
    const std::string prefix = name.empty() ? "" : name + ": ";
    for (const GltfFeature& row : kFeatures) {
        if (row.part != part || row.is_used == nullptr || !row.is_used(json, file)) continue;
        if (row.handling == GltfHandling::Refused)
            throw core::Error(where, "is compressed", row.says);
        add_once(prefix + row.says, warnings);
    }
    const Json extensions = below(json, "extensions");
    if (part == GltfPart::File || !extensions.is_object()) return;
    for (const auto& [extension, value] : extensions.items()) {
        if (is_listed(part, extension)) continue;
        add_once(prefix + "its extension " + core::printable(extension) + " is not modelled",
                 warnings);
    }
}

void check_required_extensions(const Json& file, const std::string& path) {
    const auto is_possible = [](const GltfFeature& row) {
        return row.is_used == nullptr &&
               (row.handling == GltfHandling::Applied || row.handling == GltfHandling::Beside);
    };
    for (const Json& required : below(file, "extensionsRequired")) {
        std::vector<std::string> possible;
        for (const GltfFeature& row : kFeatures) {
            if (is_possible(row) && row.handling == GltfHandling::Applied)
                possible.emplace_back(row.name);
        }
        const bool is_known =
            std::any_of(kFeatures.begin(), kFeatures.end(), [&](const GltfFeature& row) {
                return is_possible(row) && required == row.name;
            });
        if (is_known) continue;
        throw core::Error(path + ": extensionsRequired",
                          "found " + core::printable(required.dump()),
                          fmt::format("must be {} or nothing", fmt::join(possible, ", ")));
    }
}

}  // namespace renderer
