// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf_material.h"

#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/gltf/gltf_features.h"

#include <fmt/core.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>

namespace renderer {
namespace {

TextureWrap wrap_from_gltf(int wrap, const std::string& where) {
    const auto* const found = std::find(kGltfWraps.begin(), kGltfWraps.end(), wrap);
    if (found == kGltfWraps.end()) {
        throw core::Error(
            where, fmt::format("found wrap mode {}", wrap), "must be 10497, 33071 or 33648");
    }
    return static_cast<TextureWrap>(found - kGltfWraps.begin());
}

/// Width and height that a PNG or JPEG file gives; nothing where it gives none.
std::optional<std::array<std::uint64_t, 2>> declared_size(std::span<const unsigned char> bytes) {
    const auto number = [&](std::size_t at, std::size_t count) {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < count; ++i) value = value << 8 | bytes[at + i];
        return value;
    };
    if (bytes.size() < 24) return std::nullopt;
    if (number(0, 4) == 0x89504e47) return std::array{number(16, 4), number(20, 4)};
    if (number(0, 2) != 0xffd8) return std::nullopt;
    // JPEG: segments of marker and length, until the one that starts a frame (SOF0 to SOF15).
    for (std::size_t at = 2; at + 9 <= bytes.size() && bytes[at] == 0xff;) {
        const unsigned char marker = bytes[at + 1];
        const bool is_table = marker == 0xc4 || marker == 0xc8 || marker == 0xcc;
        if (marker >= 0xc0 && marker <= 0xcf && !is_table) {
            return std::array{number(at + 7, 2), number(at + 5, 2)};
        }
        at += marker == 0xff ? 1 : 2 + number(at + 2, 2);
    }
    return std::nullopt;
}

/// A few bytes can inflate to any number of texels.
void check_texels(std::span<const unsigned char> bytes, const std::string& where) {
    constexpr std::uint64_t kMostTexels = 8192 * 8192;
    const auto size = declared_size(bytes);
    if (!size || (*size)[0] == 0 || (*size)[1] <= kMostTexels / (*size)[0]) return;
    throw core::Error(where,
                      fmt::format("has {} x {} texels", (*size)[0], (*size)[1]),
                      fmt::format("must have at most {}", kMostTexels));
}

/// Decodes an image that was kept as bytes. Throws Error when there is none or it is broken.
tinygltf::Image decode_image(const GltfDocument& document, int index) {
    const std::string where = document.where(fmt::format("images[{}]", index));
    const tinygltf::Image& source = document.model->images[static_cast<std::size_t>(index)];
    if (source.image.empty()) {
        throw core::Error(where,
                          "'" + source.uri + "' cannot be read",
                          "must be a PNG or JPEG file beside the glTF file");
    }
    check_texels(source.image, where);
    tinygltf::Image image;
    std::string error;
    std::string warning;
    const bool decoded = tinygltf::LoadImageData(&image,
                                                 index,
                                                 &error,
                                                 &warning,
                                                 0,
                                                 0,
                                                 source.image.data(),
                                                 static_cast<int>(source.image.size()),
                                                 nullptr);
    if (!decoded) throw core::Error(where, "cannot be decoded", "must be a PNG or JPEG image");
    return image;
}

/// One stored channel in [0, 1], still sRGB-encoded.
double encoded_channel(const tinygltf::Image& image, std::size_t index) {
    if (image.bits != 16) return image.image[index] / 255.0;
    std::uint16_t value = 0;
    std::memcpy(&value, image.image.data() + 2 * index, sizeof(value));
    return value / 65535.0;
}

/// The base colour's mean over red, green and blue, relative to that of the factor alone: a grey
/// texture that multiplies the albedo and keeps coloured factors on coloured textures exact.
std::shared_ptr<const Texture> read_texture(const GltfDocument& document,
                                            const tinygltf::TextureInfo& info,
                                            const std::array<double, 3>& factor) {
    const auto texture_index = static_cast<std::size_t>(info.index);
    const tinygltf::Texture& source = document.model->textures[texture_index];
    if (source.source < 0) {
        throw core::Error(document.where(fmt::format("textures[{}]", texture_index)),
                          "has no source",
                          "must name an image (PNG or JPEG)");
    }
    const tinygltf::Image image = decode_image(document, source.source);

    auto texture = std::make_shared<Texture>();
    texture->width = image.width;
    texture->height = image.height;
    if (source.sampler >= 0) {
        const auto& sampler = document.model->samplers[static_cast<std::size_t>(source.sampler)];
        const std::string where = document.where(fmt::format("samplers[{}]", source.sampler));
        texture->wrap_u = wrap_from_gltf(sampler.wrapS, where);
        texture->wrap_v = wrap_from_gltf(sampler.wrapT, where);
    }
    const auto num_texels =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    const auto num_channels = static_cast<std::size_t>(image.component);
    const double factor_sum = factor[0] + factor[1] + factor[2];
    texture->luminance.resize(num_texels);
    for (std::size_t i = 0; i < num_texels; ++i) {
        double sum = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            sum += factor[c] * linear_from_srgb(encoded_channel(image, i * num_channels + c));
        }
        texture->luminance[i] = static_cast<float>(factor_sum > 0.0 ? sum / factor_sum : 0.0);
    }
    return texture;
}

core::Json base_colour_texture(const core::Json& material) {
    const core::Json pbr = material.value("pbrMetallicRoughness", core::Json::object());
    return pbr.value("baseColorTexture", core::Json::object());
}

/// What KHR_texture_transform makes of texture coordinates, and of their set.
void read_texture_transform(const core::Json& texture, LoadedMaterial& loaded) {
    const core::Json transform = texture.value("extensions", core::Json::object())
                                     .value("KHR_texture_transform", core::Json::object());
    const auto pair = [&](const char* key, double otherwise) {
        const auto numbers = transform.value(key, std::vector<double>(2, otherwise));
        return core::Vec2(numbers[0], numbers[1]);
    };
    // Turned anticlockwise as the image lies, whose v points down.
    const Eigen::Rotation2Dd rotation(-transform.value("rotation", 0.0));
    loaded.uv_transform =
        Eigen::Translation2d(pair("offset", 0.0)) * rotation * Eigen::Scaling(pair("scale", 1.0));
    loaded.texture_coordinate_set = transform.value("texCoord", loaded.texture_coordinate_set);
}

LoadedMaterial read_material(const GltfDocument& document, int index) {
    const tinygltf::Material& source = document.model->materials[static_cast<std::size_t>(index)];
    const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
    const std::array<double, 3> factor{
        pbr.baseColorFactor[0], pbr.baseColorFactor[1], pbr.baseColorFactor[2]};

    LoadedMaterial loaded;
    loaded.colour = factor;
    loaded.material.name = source.name;
    loaded.material.model = model_of({.metallic = pbr.metallicFactor > 0.0});
    loaded.material.albedo = mean_albedo(factor);
    loaded.material.roughness = pbr.roughnessFactor;
    const core::Json& json = document.json["materials"][static_cast<std::size_t>(index)];
    const std::string where = document.where(fmt::format("materials[{}]", index));
    const std::string name =
        "material " + (source.name.empty() ? std::to_string(index) : source.name);
    note_features(GltfPart::Material, json, document.json, name, where, loaded.warnings);
    if (pbr.baseColorTexture.index >= 0) {
        const core::Json texture = base_colour_texture(json);
        note_features(GltfPart::Texture, texture, document.json, name, where, loaded.warnings);
        loaded.material.albedo_texture = read_texture(document, pbr.baseColorTexture, factor);
        loaded.texture_coordinate_set = pbr.baseColorTexture.texCoord;
        read_texture_transform(texture, loaded);
    }
    loaded.extras = read_nlos_extras(json, where);
    return loaded;
}

// Keys of ours without `nlos_`, or without their unit, which would be overlooked.
void refuse_without_prefix(const std::string& key, const std::string& where) {
    NlosExtras known;
    for_each_field(known, [&](const std::string& name, const auto&, const char*) {
        const std::string bare = name.substr(std::string("nlos_").size());
        const std::string without_unit = bare.substr(0, bare.find("_m_per_s"));
        if (key != bare && key != without_unit && key != "nlos_" + without_unit) return;
        if (key == name) return;
        throw core::Error(where + ".extras", "found " + key, "must be " + name);
    });
}

}  // namespace

SurfaceModel NlosExtras::model_or(SurfaceModel otherwise) const {
    if (retroreflective.value_or(false)) return model_of({.retroreflective = true});
    return surface_model.value_or(otherwise);
}

NlosExtras NlosExtras::or_else(const NlosExtras& fallback) const {
    NlosExtras merged = *this;
    if (!merged.role) merged.role = fallback.role;
    if (!merged.ellipsoidal_exclude) merged.ellipsoidal_exclude = fallback.ellipsoidal_exclude;
    if (!merged.velocity_m_per_s) merged.velocity_m_per_s = fallback.velocity_m_per_s;
    if (!merged.retroreflective) merged.retroreflective = fallback.retroreflective;
    if (!merged.surface_model) merged.surface_model = fallback.surface_model;
    return merged;
}

NlosExtras read_nlos_extras(const core::Json& owner, const std::string& where) {
    core::Json ours = core::Json::object();
    if (const auto extras = owner.find("extras"); extras != owner.end() && extras->is_object()) {
        for (const auto& [key, value] : extras->items()) {
            if (key.starts_with("nlos_")) ours[key] = value;
            refuse_without_prefix(key, where);
        }
    }
    NlosExtras result;
    core::read_value(ours, where + ".extras", result);
    return result;
}

const LoadedMaterial& MaterialReader::read(int index) {
    const auto found = loaded_.find(index);
    if (found != loaded_.end()) return found->second;
    return loaded_.emplace(index, index < 0 ? LoadedMaterial{} : read_material(document_, index))
        .first->second;
}

}  // namespace renderer
