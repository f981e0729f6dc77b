// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf_document.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>

namespace renderer {
namespace {

using core::Json;

enum class Presence { Optional, Required };

/// Walks the parts of a glTF's JSON that the loader uses. tinygltf itself takes a value of a wrong
/// type for a missing one, narrows numbers silently and leaves indices and extents unchecked.
class GltfChecker {
 public:
    GltfChecker(const Json& root, const std::string& path) : root_(root), path_(path) {}

    void check() {
        if (!root_.is_object()) fail("its JSON", root_, "an object");
        check_extensions();
        each("buffers", [this](const Json& buffer, const std::string& where) {
            check_count(buffer, where, "byteLength", Presence::Required, 1);
            check_text(buffer, where, "uri");
        });
        each("bufferViews", [this](const Json& view, const std::string& where) {
            check_buffer_view(view, where);
        });
        each("accessors", [this](const Json& accessor, const std::string& where) {
            check_accessor(accessor, where);
        });
        each("meshes",
             [this](const Json& mesh, const std::string& where) { check_mesh(mesh, where); });
        each("nodes",
             [this](const Json& node, const std::string& where) { check_node(node, where); });
        each("scenes", [this](const Json& scene, const std::string& where) {
            check_indices(scene, where, "nodes", "nodes");
        });
        check_index(root_, "", "scene", "scenes");
        each("cameras",
             [this](const Json& camera, const std::string& where) { check_camera(camera, where); });
        check_appearance();
        check_extras(root_, "");
    }

 private:
    [[noreturn]] void fail(const std::string& where,
                           const Json& found,
                           const std::string& allowed) const {
        core::throw_wrong_type(path_ + ": " + where, found, allowed);
    }

    static const Json* find(const Json& owner, const char* key) {
        const auto it = owner.find(key);
        return it == owner.end() ? nullptr : &*it;
    }

    /// The member `key` of `owner`; null when absent and optional.
    const Json* find(const Json& owner,
                     const std::string& where,
                     const char* key,
                     Presence presence) const {
        const Json* value = find(owner, key);
        if (!value && presence == Presence::Required) {
            throw core::Error(
                path_ + ": " + where, std::string("has no ") + key, "glTF 2.0 requires it");
        }
        return value;
    }

    std::size_t count_of(const char* array) const {
        const Json* items = find(root_, array);
        return items ? items->size() : 0;
    }

    template <class Check>
    void each(const char* array, const Check& check) const {
        const Json* items = find(root_, array);
        if (!items) return;
        if (!items->is_array()) fail(array, *items, "a list");
        for (std::size_t i = 0; i < items->size(); ++i) {
            const std::string where = std::string(array) + "[" + std::to_string(i) + "]";
            if (!(*items)[i].is_object()) fail(where, (*items)[i], "an object");
            check_text((*items)[i], where, "name");
            check((*items)[i], where);
        }
    }

    void check_text(const Json& owner, const std::string& where, const char* key) const {
        const Json* value = find(owner, key);
        if (value && !value->is_string()) fail(core::join_key(where, key), *value, "a text");
    }

    void check_count(const Json& owner,
                     const std::string& where,
                     const char* key,
                     Presence presence = Presence::Optional,
                     std::uint64_t smallest = 0) const {
        const Json* value = find(owner, where, key, presence);
        if (!value) return;
        constexpr auto kLargest = std::uint64_t{std::numeric_limits<int>::max()};
        if (!value->is_number_unsigned() || value->get<std::uint64_t>() < smallest ||
            value->get<std::uint64_t>() > kLargest) {
            fail(core::join_key(where, key),
                 *value,
                 "a whole number from " + std::to_string(smallest) + " to " +
                     std::to_string(kLargest));
        }
    }

    void check_index_value(const Json& value, const std::string& where, const char* target) const {
        const std::size_t count = count_of(target);
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count) {
            fail(where,
                 value,
                 "an index below " + std::to_string(count) + ", the number of " + target);
        }
    }

    void check_index(const Json& owner,
                     const std::string& where,
                     const char* key,
                     const char* target,
                     Presence presence = Presence::Optional) const {
        if (const Json* value = find(owner, where, key, presence)) {
            check_index_value(*value, core::join_key(where, key), target);
        }
    }

    void check_indices(const Json& owner,
                       const std::string& where,
                       const char* key,
                       const char* target) const {
        const Json* list = find(owner, key);
        if (!list) return;
        const std::string place = core::join_key(where, key);
        if (!list->is_array()) fail(place, *list, "a list of indices");
        for (const Json& item : *list) check_index_value(item, place, target);
    }

    void check_numbers(const Json& owner,
                       const std::string& where,
                       const char* key,
                       std::size_t count) const {
        const Json* list = find(owner, key);
        if (!list) return;
        const bool numbers = list->is_array() && list->size() == count &&
                             std::all_of(list->begin(), list->end(), [](const Json& item) {
                                 return item.is_number();
                             });
        if (!numbers) {
            fail(core::join_key(where, key),
                 *list,
                 "a list of " + std::to_string(count) + " numbers");
        }
    }

    void check_fraction(const Json& value, const std::string& where) const {
        if (!value.is_number() || value.get<double>() < 0.0 || value.get<double>() > 1.0) {
            fail(where, value, "a number from 0 to 1");
        }
    }

    const Json* check_object(const Json& owner,
                             const std::string& where,
                             const char* key,
                             Presence presence = Presence::Optional) const {
        const Json* value = find(owner, where, key, presence);
        if (value && !value->is_object()) fail(core::join_key(where, key), *value, "an object");
        return value;
    }

    /// Extensions change what the data means, so one that is required and unknown ends the reading.
    void check_extensions() const {
        const Json* required = find(root_, "extensionsRequired");
        if (!required) return;
        if (!required->is_array()) fail("extensionsRequired", *required, "a list of texts");
        for (const Json& name : *required) {
            if (name != "KHR_mesh_quantization") {
                fail("extensionsRequired", name, "KHR_mesh_quantization or nothing");
            }
        }
    }

    void check_buffer_view(const Json& view, const std::string& where) const {
        check_index(view, where, "buffer", "buffers", Presence::Required);
        check_count(view, where, "byteOffset");
        check_count(view, where, "byteLength", Presence::Required, 1);
        check_count(view, where, "byteStride", Presence::Optional, 4);
        // Counts are below 2^31 and their sum cannot overflow 64 bits.
        const auto end =
            view.value("byteOffset", std::uint64_t{0}) + view["byteLength"].get<std::uint64_t>();
        const Json& buffer = root_["buffers"][view["buffer"].get<std::size_t>()];
        if (const auto size = buffer["byteLength"].get<std::uint64_t>(); end > size) {
            throw core::Error(path_ + ": " + where,
                              "ends at byte " + std::to_string(end) + " of its buffer",
                              "the buffer has " + std::to_string(size) + " bytes");
        }
    }

    void check_accessor(const Json& accessor, const std::string& where) const {
        check_index(accessor, where, "bufferView", "bufferViews");
        check_count(accessor, where, "byteOffset");
        check_count(accessor, where, "componentType", Presence::Required);
        check_count(accessor, where, "count", Presence::Required, 1);
        find(accessor, where, "type", Presence::Required);
        check_text(accessor, where, "type");
        if (const Json* value = find(accessor, "normalized"); value && !value->is_boolean()) {
            fail(core::join_key(where, "normalized"), *value, "true or false");
        }
        const Json* sparse = check_object(accessor, where, "sparse");
        if (!sparse) return;
        const std::string place = core::join_key(where, "sparse");
        check_count(*sparse, place, "count", Presence::Required, 1);
        for (const char* part : {"indices", "values"}) {
            const Json* item = check_object(*sparse, place, part, Presence::Required);
            const std::string inner = core::join_key(place, part);
            check_index(*item, inner, "bufferView", "bufferViews", Presence::Required);
            check_count(*item, inner, "byteOffset");
        }
        check_count((*sparse)["indices"],
                    core::join_key(place, "indices"),
                    "componentType",
                    Presence::Required);
    }

    void check_mesh(const Json& mesh, const std::string& where) const {
        const Json* primitives = find(mesh, where, "primitives", Presence::Required);
        const std::string list = core::join_key(where, "primitives");
        if (!primitives->is_array() || primitives->empty()) {
            fail(list, *primitives, "a list of at least one primitive");
        }
        for (std::size_t i = 0; i < primitives->size(); ++i) {
            const Json& primitive = (*primitives)[i];
            const std::string place = list + "[" + std::to_string(i) + "]";
            if (!primitive.is_object()) fail(place, primitive, "an object");
            const Json* attributes =
                check_object(primitive, place, "attributes", Presence::Required);
            for (const auto& [name, index] : attributes->items()) {
                check_index_value(index, place + ".attributes." + name, "accessors");
            }
            check_index(primitive, place, "indices", "accessors");
            check_index(primitive, place, "material", "materials");
            check_count(primitive, place, "mode");
        }
    }

    void check_node(const Json& node, const std::string& where) const {
        check_index(node, where, "mesh", "meshes");
        check_index(node, where, "camera", "cameras");
        check_indices(node, where, "children", "nodes");
        check_numbers(node, where, "matrix", 16);
        check_numbers(node, where, "translation", 3);
        check_numbers(node, where, "rotation", 4);
        check_numbers(node, where, "scale", 3);
    }

    void check_camera(const Json& camera, const std::string& where) const {
        const Json* perspective = check_object(camera, where, "perspective");
        const Json* yfov = perspective ? find(*perspective, "yfov") : nullptr;
        if (yfov &&
            !(yfov->is_number() && yfov->get<double>() > 0.0 && yfov->get<double>() < core::kPi)) {
            fail(where + ".perspective.yfov", *yfov, "an angle between 0 and pi");
        }
    }

    void check_appearance() const {
        each("materials", [this](const Json& material, const std::string& where) {
            check_material(material, where);
        });
        each("textures", [this](const Json& texture, const std::string& where) {
            check_index(texture, where, "source", "images");
            check_index(texture, where, "sampler", "samplers");
        });
        each("images", [this](const Json& image, const std::string& where) {
            check_text(image, where, "uri");
            check_index(image, where, "bufferView", "bufferViews");
        });
        each("samplers", [this](const Json& sampler, const std::string& where) {
            check_count(sampler, where, "wrapS");
            check_count(sampler, where, "wrapT");
        });
    }

    void check_material(const Json& material, const std::string& where) const {
        const Json* pbr = check_object(material, where, "pbrMetallicRoughness");
        if (!pbr) return;
        const std::string place = core::join_key(where, "pbrMetallicRoughness");
        check_numbers(*pbr, place, "baseColorFactor", 4);
        if (const Json* color = find(*pbr, "baseColorFactor")) {
            for (const Json& value : *color) check_fraction(value, place + ".baseColorFactor");
        }
        for (const char* key : {"metallicFactor", "roughnessFactor"}) {
            if (const Json* value = find(*pbr, key)) check_fraction(*value, place + "." + key);
        }
        if (const Json* texture = check_object(*pbr, place, "baseColorTexture")) {
            const std::string inner = place + ".baseColorTexture";
            check_index(*texture, inner, "index", "textures", Presence::Required);
            check_count(*texture, inner, "texCoord");
        }
    }

    /// Our extras anywhere but on nodes and materials would be ignored without a word.
    void check_extras(const Json& value, const std::string& where) const {
        if (value.is_array()) {
            for (std::size_t i = 0; i < value.size(); ++i) {
                check_extras(value[i], where + "[" + std::to_string(i) + "]");
            }
        }
        if (!value.is_object()) return;
        for (const auto& [key, item] : value.items()) {
            const std::string place = core::join_key(where, key);
            if (key == "extras" && item.is_object()) {
                if (is_node_or_material(where)) continue;
                for (const auto& [name, unused] : item.items()) {
                    if (name.starts_with("nlos_")) {
                        throw core::Error(path_ + ": " + core::join_key(place, name),
                                          "is not on a node or a material",
                                          "nlos_ extras belong on nodes and materials");
                    }
                }
            } else {
                check_extras(item, place);
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
}

}  // namespace renderer
