// SPDX-License-Identifier: MIT
#include "renderer/scene_import/scene_import.h"

#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/scene_import/foreign_file.h"
#include "renderer/scene_import/key_reader.h"

#include <algorithm>
#include <filesystem>

namespace renderer {
namespace {

namespace fs = std::filesystem;

bool has_suffix(const std::string& path, std::initializer_list<const char*> suffixes) {
    const std::string suffix = fs::path(path).extension().string();
    return std::find(suffixes.begin(), suffixes.end(), suffix) != suffixes.end();
}

bool is_yaml(const std::string& path) {
    return has_suffix(path, {".yaml", ".yml"});
}

/// The same with texts and keys of one line each, as messages and names need them.
core::Json printable_texts(const core::Json& json, const std::string& path, int depth = 0) {
    constexpr int kDeepest = 64;
    if (depth > kDeepest) throw core::Error(path, "nests too deep", "must be a plain scene");
    if (json.is_string()) return core::printable(json.get<std::string>());
    if (!json.is_structured()) return json;
    core::Json result = json.is_array() ? core::Json::array() : core::Json::object();
    for (const auto& [key, value] : json.items()) {
        core::Json item = printable_texts(value, path, depth + 1);
        if (json.is_array()) {
            result.push_back(std::move(item));
        } else {
            result[core::printable(key)] = std::move(item);
        }
    }
    return result;
}

ImportedScene import_by_kind(const std::string& path) {
    if (is_yaml(path)) return import_ytal(printable_texts(read_yaml(path), path), path);
    const core::Json scene =
        has_suffix(path, {".xml"}) ? read_mitsuba_xml(path) : core::read_json_file(path);
    if (type_of(scene) != "scene") {
        throw core::Error(path, "is no scene of Mitsuba", "must have the type scene at its root");
    }
    return import_mitsuba(printable_texts(scene, path), path);
}

/// Without what is null or an empty list.
core::Json non_default(const core::Json& json) {
    core::Json result = core::Json::object();
    for (const auto& [key, value] : json.items()) {
        if (!value.is_null() && !(value.is_array() && value.empty())) result[key] = value;
    }
    return result;
}

}  // namespace

ImportedScene import_scene(const std::string& path) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) {
        throw core::Error(
            path, "is no file", "must be a scene of Mitsuba (.xml, .json) or y-tal (.yaml)");
    }
    ImportedScene scene = import_by_kind(path);
    if (scene.geometry.objects.empty()) {
        throw core::Error(
            path, "has no hidden objects that are known here", "must have at least one");
    }
    scene.not_translated.emplace_back(
        "surfaces scatter on both sides here, in Mitsuba only those with twosided do; and by the "
        "normals of facets, where Mitsuba may interpolate those of vertices");
    validate(scene.description, path + ", translated: ");
    return scene;
}

core::Json imported_scene_json(const ImportedScene& scene, const std::string& geometry) {
    const SceneDescription& description = scene.description;
    core::Json scan = non_default(core::write_value(description.scan));
    if (description.scan.pattern != core::ScanPattern::Exhaustive)
        scan.erase("illumination_points");
    return {{"geometry", geometry},
            {"relay_wall", core::write_value(description.relay_wall)},
            {"scan", scan},
            {"time_axis", write_value(description.time_axis)},
            {"render", {{"max_bounces", description.render.max_bounces}}}};
}

}  // namespace renderer
