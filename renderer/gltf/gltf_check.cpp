// SPDX-License-Identifier: MIT
#include "renderer/core/settings/settings_json.h"
#include "renderer/gltf/gltf_document.h"
#include "renderer/gltf/gltf_features.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

namespace renderer {
namespace {

using core::Json;

/// What a value must be, in words and as a test.
struct Allowed {
    std::string text;
    std::function<bool(const Json&)> holds;
};

Allowed a_text() {
    return {"a text", [](const Json& value) { return value.is_string(); }};
}

Allowed a_number() {
    return {"a number", [](const Json& value) { return value.is_number(); }};
}

Allowed a_flag() {
    return {"true or false", [](const Json& value) { return value.is_boolean(); }};
}

/// Counts are below 2^31, so that sums of two cannot overflow 64 bits.
Allowed count_from(std::uint64_t smallest) {
    constexpr auto kLargest = std::uint64_t{std::numeric_limits<std::int32_t>::max()};
    return {"a whole number from " + std::to_string(smallest) + " to " + std::to_string(kLargest),
            [=](const Json& value) {
                return value.is_number_unsigned() && value.get<std::uint64_t>() >= smallest &&
                       value.get<std::uint64_t>() <= kLargest;
            }};
}

/// Parts beyond that cost gigabytes and minutes before any triangle is read.
Allowed few_enough() {
    constexpr std::size_t kMost = 100'000;
    return {"a list of at most " + std::to_string(kMost) + " items",
            [=](const Json& list) { return list.is_array() && list.size() <= kMost; }};
}

Allowed numbers(std::size_t count) {
    return {"a list of " + std::to_string(count) + " numbers", [=](const Json& list) {
                return list.is_array() && list.size() == count &&
                       std::all_of(list.begin(), list.end(), [](const Json& item) {
                           return item.is_number();
                       });
            }};
}

Allowed a_fraction() {
    return {"a number from 0 to 1", [](const Json& value) {
                return value.is_number() && value.get<double>() >= 0.0 &&
                       value.get<double>() <= 1.0;
            }};
}

/// Checks the parts of a glTF's JSON that the loader uses. tinygltf itself takes a value of a wrong
/// type for a missing one, narrows numbers silently and leaves indices and extents unchecked.
class GltfChecker {
 public:
    GltfChecker(const Json& root, const std::string& path) : root_(root), path_(path) {}

    void check() const {
        if (!root_.is_object()) fail("its JSON", root_, "an object");
        for (const char* array : {"buffers",
                                  "bufferViews",
                                  "accessors",
                                  "meshes",
                                  "nodes",
                                  "skins",
                                  "scenes",
                                  "cameras",
                                  "materials",
                                  "textures",
                                  "images",
                                  "samplers"}) {
            check(root_, "", array, few_enough());
            check(root_, "", std::string(array) + "[].name", a_text());
        }
        check_values();
        for (std::size_t i = 0; i < count_of("bufferViews"); ++i) check_extent(i);
        check_extras(root_, "");
    }

 private:
    /// Every value in use, buffers first: what is named there may be relied on afterwards.
    void check_values() const {
        const std::string kTextureTransform =
            "materials[].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.";
        const struct {
            std::string key_path;  ///< as check() reads it
            Allowed allowed;
        } kRules[] = {
            {"extensionsRequired[]", a_text()},
            {"buffers[].byteLength!", count_from(1)},
            {"buffers[].uri", a_text()},
            {"bufferViews[].buffer!", index_of("buffers")},
            {"bufferViews[].byteOffset", count_from(0)},
            {"bufferViews[].byteLength!", count_from(1)},
            {"bufferViews[].byteStride", count_from(4)},
            {"accessors[].bufferView", index_of("bufferViews")},
            {"accessors[].byteOffset", count_from(0)},
            {"accessors[].componentType!", count_from(0)},
            {"accessors[].count!", count_from(1)},
            {"accessors[].type!", a_text()},
            {"accessors[].normalized", a_flag()},
            {"accessors[].sparse.count!", count_from(1)},
            {"accessors[].sparse.indices!.bufferView!", index_of("bufferViews")},
            {"accessors[].sparse.indices!.byteOffset", count_from(0)},
            {"accessors[].sparse.indices!.componentType!", count_from(0)},
            {"accessors[].sparse.values!.bufferView!", index_of("bufferViews")},
            {"accessors[].sparse.values!.byteOffset", count_from(0)},
            {"meshes[].primitives!",
             {"a list of at least one primitive",
              [](const Json& value) { return value.is_array() && !value.empty(); }}},
            {"meshes[].primitives![].attributes!.*", index_of("accessors")},
            {"meshes[].primitives![].indices", index_of("accessors")},
            {"meshes[].primitives![].material", index_of("materials")},
            {"meshes[].primitives![].mode", count_from(0)},
            {"meshes[].primitives![].targets[].*", index_of("accessors")},
            {"meshes[].weights[]", a_number()},
            {"nodes[].mesh", index_of("meshes")},
            {"nodes[].skin", index_of("skins")},
            {"nodes[].weights[]", a_number()},
            {"nodes[].extensions.EXT_mesh_gpu_instancing.attributes.*", index_of("accessors")},
            {"nodes[].extensions.KHR_node_visibility.visible", a_flag()},
            {"skins[].joints!",
             {"a list of at least one node",
              [](const Json& value) { return value.is_array() && !value.empty(); }}},
            {"skins[].joints![]", index_of("nodes")},
            {"skins[].inverseBindMatrices", index_of("accessors")},
            {"nodes[].camera", index_of("cameras")},
            {"nodes[].children[]", index_of("nodes")},
            {"nodes[].matrix", numbers(16)},
            {"nodes[].translation", numbers(3)},
            {"nodes[].rotation", numbers(4)},
            {"nodes[].scale", numbers(3)},
            {"scenes[].nodes[]", index_of("nodes")},
            {"scene", index_of("scenes")},
            {"cameras[].perspective.yfov",
             {"an angle between 0 and pi",
              [](const Json& value) {
                  return value.is_number() && value.get<double>() > 0.0 &&
                         value.get<double>() < core::kPi;
              }}},
            {"materials[].pbrMetallicRoughness.baseColorFactor", numbers(4)},
            {"materials[].pbrMetallicRoughness.baseColorFactor[]", a_fraction()},
            {"materials[].pbrMetallicRoughness.metallicFactor", a_fraction()},
            {"materials[].pbrMetallicRoughness.roughnessFactor", a_fraction()},
            {"materials[].pbrMetallicRoughness.baseColorTexture.index!", index_of("textures")},
            {"materials[].pbrMetallicRoughness.baseColorTexture.texCoord", count_from(0)},
            {kTextureTransform + "offset", numbers(2)},
            {kTextureTransform + "rotation", a_number()},
            {kTextureTransform + "scale", numbers(2)},
            {kTextureTransform + "texCoord", count_from(0)},
            {"textures[].source", index_of("images")},
            {"textures[].sampler", index_of("samplers")},
            {"images[].uri", a_text()},
            {"images[].bufferView", index_of("bufferViews")},
            {"samplers[].wrapS", count_from(0)},
            {"samplers[].wrapT", count_from(0)},
        };
        for (const auto& rule : kRules) check(root_, "", rule.key_path, rule.allowed);
    }

    std::size_t count_of(const char* array) const {
        const auto items = root_.find(array);
        return items == root_.end() ? 0 : items->size();
    }

    Allowed index_of(const char* array) const {
        const std::size_t count = count_of(array);
        return {"an index below " + std::to_string(count) + ", the number of " + array,
                [=](const Json& value) {
                    return value.is_number_unsigned() && value.get<std::uint64_t>() < count;
                }};
    }

    [[noreturn]] void fail(const std::string& where,
                           const Json& found,
                           const std::string& allowed) const {
        core::throw_wrong_type(path_ + ": " + where, found, allowed);
    }

    /// Checks all values at a place below `owner`.
    ///
    /// where   the owner's own place, for messages
    /// place   keys by dots; `[]` stands for every item of a list, `*` for every member of an
    ///         object; `!` marks keys that must be there, others may be missing
    void check(const Json& owner,
               const std::string& where,
               std::string_view key_path,
               const Allowed& allowed) const {
        if (key_path.empty()) {
            if (!allowed.holds(owner)) fail(where, owner, allowed.text);
            return;
        }
        if (key_path.starts_with("[]")) {
            key_path.remove_prefix(2);
            if (!owner.is_array()) fail(where, owner, "a list");
            for (std::size_t i = 0; i < owner.size(); ++i) {
                const std::string item = where + "[" + std::to_string(i) + "]";
                check(owner[i], key_path.empty() ? where : item, key_path, allowed);
            }
            return;
        }
        if (key_path.starts_with('.')) key_path.remove_prefix(1);
        if (!owner.is_object()) fail(where, owner, "an object");
        const std::string key(key_path.substr(0, key_path.find_first_of("!.[")));
        key_path.remove_prefix(key.size());
        if (key == "*") {
            for (const auto& [name, item] : owner.items()) {
                check(item, core::join_key(where, name), key_path, allowed);
            }
            return;
        }
        const bool is_required = key_path.starts_with('!');
        if (is_required) key_path.remove_prefix(1);
        if (const auto value = owner.find(key); value != owner.end()) {
            check(*value, core::join_key(where, key), key_path, allowed);
        } else if (is_required) {
            throw core::Error(path_ + ": " + where, "has no " + key, "glTF 2.0 requires it");
        }
    }

    void check_extent(std::size_t index) const {
        const Json& view = root_["bufferViews"][index];
        const auto end =
            view.value("byteOffset", std::uint64_t{0}) + view["byteLength"].get<std::uint64_t>();
        const Json& buffer = root_["buffers"][view["buffer"].get<std::size_t>()];
        if (const auto size = buffer["byteLength"].get<std::uint64_t>(); end > size) {
            throw core::Error(path_ + ": bufferViews[" + std::to_string(index) + "]",
                              "ends at byte " + std::to_string(end) + " of its buffer",
                              "the buffer has " + std::to_string(size) + " bytes");
        }
    }

    /// nlos_ extras anywhere but on nodes and materials would be silently ignored.
    void check_extras(const Json& value, const std::string& where) const {
        if (value.is_array()) {
            for (std::size_t i = 0; i < value.size(); ++i) {
                check_extras(value[i], where + "[" + std::to_string(i) + "]");
            }
        }
        if (!value.is_object()) return;
        for (const auto& [key, item] : value.items()) {
            const std::string key_path = core::join_key(where, key);
            if (key == "extras" && item.is_object()) {
                if (is_node_or_material(where)) continue;
                for (const auto& [name, unused] : item.items()) {
                    if (name.starts_with("nlos_")) {
                        throw core::Error(path_ + ": " + core::join_key(key_path, name),
                                          "is not on a node or a material",
                                          "nlos_ extras belong on nodes and materials");
                    }
                }
            } else {
                check_extras(item, key_path);
            }
        }
    }

    static bool is_node_or_material(const std::string& where) {
        return where.find('.') == std::string::npos &&
               (where.starts_with("nodes[") || where.starts_with("materials["));
    }

    const Json& root_;
    const std::string& path_;
};

}  // namespace

void check_gltf_json(const Json& json, const std::string& path) {
    GltfChecker(json, path).check();
    check_required_extensions(json, path);
}

}  // namespace renderer
