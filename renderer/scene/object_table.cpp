// SPDX-License-Identifier: MIT
#include "renderer/scene/object_table.h"

#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <filesystem>

namespace renderer {
namespace {

// The name of an array's entry: its own, else that of its mesh's file, numbered when it is taken.
std::string name_of(const core::Json& entry, const std::string& where, const ObjectTable& objects) {
    if (const auto name = entry.find("name"); name != entry.end()) {
        if (!name->is_string()) core::throw_wrong_type(where + ".name", *name, "a text");
        if (!objects.contains(*name)) return *name;
        throw core::Error(where + ".name",
                          "found " + name->dump() + " for the second time",
                          "must differ from the others");
    }
    const auto mesh = entry.find("mesh");
    if (mesh == entry.end()) {
        throw core::Error(where, "found no mesh and no name", "must have one of them");
    }
    if (!mesh->is_string()) core::throw_wrong_type(where + ".mesh", *mesh, "a text");
    const std::string stem = std::filesystem::path(mesh->get<std::string>()).stem().string();
    std::string name = stem;
    for (int i = 2; objects.contains(name); ++i) name = fmt::format("{}_{}", stem, i);
    return name;
}

}  // namespace

void read_value(const core::Json& json, const std::string& where, ObjectTable& objects) {
    if (json.is_array()) {
        objects.clear();
        for (std::size_t i = 0; i < json.size(); ++i) {
            const std::string key_path = fmt::format("{}[{}]", where, i);
            if (!json[i].is_object()) core::throw_wrong_type(key_path, json[i], "an object");
            core::Json entry = json[i];
            const std::string name = name_of(entry, key_path, objects);
            entry.erase("name");
            core::read_value(entry, key_path, objects[name]);
        }
        return;
    }
    if (!json.is_object()) {
        core::throw_wrong_type(where, json, "an object with names of objects, or an array of them");
    }
    for (const auto& [name, settings] : json.items()) {
        core::read_value(settings, core::join_key(where, name), objects[name]);
    }
}

void validate(const ObjectTable& objects, const std::string& where) {
    for (const auto& [name, object] : objects) {
        const std::string key_path = core::join_key(where, name);
        core::check_ranges(object, key_path);
        if (object.material) core::check_ranges(*object.material, key_path + ".material");
        const auto refuse = [&](const char* key, const char* found, const char* allowed) {
            throw core::Error(key_path + "." + key, found, allowed);
        };
        if (object.up && object.mesh && !is_mesh_file(*object.mesh)) {
            refuse("up", "found with a glTF file", "must be left out: glTF has y up");
        }
        if (object.mesh) continue;
        constexpr auto kFound = "found without mesh";
        constexpr auto kAllowed = "must stand beside the mesh that it places";
        if (object.scale) refuse("scale", kFound, kAllowed);
        if (object.up) refuse("up", kFound, kAllowed);
        if (object.rotation_deg) refuse("rotation_deg", kFound, kAllowed);
        if (object.translation_m) refuse("translation_m", kFound, kAllowed);
    }
}

}  // namespace renderer
