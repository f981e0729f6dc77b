// SPDX-License-Identifier: MIT
#include "apps/dataset/recipe.h"

#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <set>

namespace apps {
namespace {

namespace fs = std::filesystem;

/// Setting keys whose value decides about the shape of an array.
bool changes_shapes(const std::string& key) {
    static const std::set<std::string> keys{"scene.scan.pattern",
                                            "scene.scan.sensing_points",
                                            "scene.scan.illumination_points",
                                            "scene.scan.sensing_points_m",
                                            "scene.scan.illumination_points_m",
                                            "scene.time_axis.num_bins",
                                            "scene.ground_truth.depth_resolution"};
    return keys.contains(key);
}

void validate_scene(const renderer::SceneDescription& scene, const std::string& where) {
    const auto refuse = [&](const char* key, const char* reason) {
        throw core::Error(where + "scene." + key, "found in a recipe", reason);
    };
    const renderer::RenderSettings& render = scene.render;
    if (!scene.geometry.empty()) refuse("geometry", "must be left out: meshes says what is drawn");
    if (!scene.objects.empty()) refuse("objects", "must be left out: objects are drawn");
    if (scene.camera) refuse("camera", "must be left out: items are scans of a relay wall");
    if (scene.frames) refuse("frames", "must be left out: items are single captures");
    if (scene.velocity_axis) refuse("velocity_axis", "must be left out: objects are at rest");
    if (scene.time_axis.automatic) refuse("time_axis", "must be an object, the same for all items");
    if (render.seconds) refuse("render.seconds", "must be left out: times differ from run to run");
    if (render.variance) refuse("render.variance", "must be false: variances are not stored");
    if (render.by_order) refuse("render.by_order", "must be false: orders are not stored apart");
    if (render.seed != 0) refuse("render.seed", "must be left out: seed says all");
}

void validate_item(const ItemSettings& settings, const std::string& where) {
    renderer::validate(settings.scene, where + "scene.");
    if (!settings.detector) return;
    const nlos::DetectorSettings& detector = *settings.detector;
    if (!detector.photons && !detector.photons_per_point && !detector.exposure_s) {
        throw core::Error(where + "detector",
                          "found no amount of light",
                          "must have photons, photons_per_point or exposure_s");
    }
    try {
        nlos::validate(detector);
    } catch (const core::Error& error) {
        throw core::Error(where + "detector." + error.where(), error.found(), error.allowed());
    }
}

void validate_storage(const Recipe& recipe, const ItemSettings& item, const std::string& where) {
    core::check_ranges(recipe.storage, where + "storage");
    const bool whole = recipe.storage.histograms == HistogramStorage::Uint8 ||
                       recipe.storage.histograms == HistogramStorage::Uint16;
    if (whole && (!item.detector || item.detector->expected)) {
        throw core::Error(where + "storage.histograms",
                          fmt::format("found {}", core::enum_name(recipe.storage.histograms)),
                          "must be float32 or float16 unless a detector draws counts");
    }
}

void validate_truths(const Recipe& recipe, const std::string& where) {
    std::set<Truth> named;
    for (const Truth truth : recipe.truths) {
        if (named.insert(truth).second) continue;
        throw core::Error(where + "truths",
                          fmt::format("found {} twice", core::enum_name(truth)),
                          "must name each once");
    }
}

/// One value must not be drawn by two entries.
void validate_keys(const DrawTable& draws, const std::string& where) {
    for (const auto& [key, distribution] : draws) {
        const auto inner = draws.lower_bound(key + ".");
        if (inner == draws.end() || !inner->first.starts_with(key + ".")) continue;
        throw core::Error(
            where + "draw." + inner->first, "found beside " + key, "must be in one of the two");
    }
}

void validate_all(const Recipe& recipe, const ItemSettings& item, const std::string& where) {
    validate_scene(item.scene, where);
    validate_item(item, where);
    validate_storage(recipe, item, where);
}

/// What every item may get, key by key, so that no run of hours ends at a bad draw.
void validate_draws(const Recipe& recipe, const std::string& where) {
    validate_keys(recipe.draw, where);
    for (const auto& [key, distribution] : recipe.draw) {
        const std::string full_key = where + "draw." + key;
        for (const core::Json& value : extremes(distribution)) {
            ItemSettings settings = recipe;
            try {
                apply_values({{key, value}}, settings);
                validate_all(recipe, settings, "");
            } catch (const core::Error& error) {
                throw core::Error(full_key + ": " + error.where(), error.found(), error.allowed());
            }
        }
        if (recipe.format == DatasetFormat::Hdf5 && changes_shapes(key)) {
            throw core::Error(full_key,
                              "found a shape that differs between items",
                              "must be fixed in HDF5; format webdataset allows it");
        }
    }
}

void validate_counts(const Recipe& recipe, const std::string& where) {
    constexpr double kMostShards = 1e6;
    const double shards =
        static_cast<double>(recipe.items) / static_cast<double>(recipe.items_per_shard);
    core::require(shards <= kMostShards,
                  where + "items_per_shard",
                  static_cast<double>(recipe.items_per_shard),
                  fmt::format("at least {:.0f} for so many items",
                              static_cast<double>(recipe.items) / kMostShards));
    const Distribution& count = recipe.objects.count;
    for (const core::Json& value : extremes(count)) {
        const double number = value.get<double>();
        const bool whole =
            number == std::floor(number) && (count.kind == Distribution::Kind::Integers ||
                                             count.kind == Distribution::Kind::Constant ||
                                             count.kind == Distribution::Kind::Choices);
        core::require(whole, where + "objects.count", write_value(count).dump(), "whole numbers");
    }
}

void validate(const Recipe& recipe, const std::string& where) {
    core::check_ranges(recipe, where);
    core::check_ranges(recipe.objects, where + "objects");
    const ObjectDistributions& objects = recipe.objects;
    for (const auto& [key, target] :
         {std::pair{"x_m", &objects.x_m}, {"y_m", &objects.y_m}, {"z_m", &objects.z_m}}) {
        check_range(*target, {}, where + "objects." + key);  // any number
    }
    validate_counts(recipe, where);
    const MeshSource& meshes = recipe.meshes;
    core::check_ranges(meshes, where + "meshes");
    if (meshes.folder.empty() && meshes.files.empty() && meshes.shapes.empty()) {
        throw core::Error(
            where + "meshes", "found no source", "must have a folder, files or shapes");
    }
    validate_truths(recipe, where);
    validate_all(recipe, recipe, where);
    validate_draws(recipe, where);
}

}  // namespace

core::Json write_identity(const Recipe& recipe) {
    core::Json json = core::write_value(recipe);
    json.erase("items");
    json["meshes"].erase("folder");
    json["meshes"].erase("files");
    return json;
}

void apply_values(const core::Json& values, ItemSettings& settings) {
    core::Json changes = core::Json::object();
    for (const auto& [key, value] : values.items()) {
        core::Json* target = &changes;
        std::size_t begin = 0;
        for (std::size_t dot; (dot = key.find('.', begin)) != std::string::npos; begin = dot + 1) {
            target = &(*target)[key.substr(begin, dot - begin)];
        }
        (*target)[key.substr(begin)] = value;
    }
    core::read_value(changes, "", settings);
}

std::uint64_t stream_of(std::string_view name) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a [Fowler1991]
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    return hash;
}

Recipe read_recipe(const std::string& path, const std::vector<std::string>& overrides) {
    Recipe recipe;
    core::read_value(core::read_json_file(path), path + ": ", recipe);
    const fs::path folder = fs::path(path).parent_path();
    const auto beside_recipe = [&](std::string& file) {
        if (!file.empty()) file = (folder / file).string();
    };
    beside_recipe(recipe.meshes.folder);
    for (std::string& file : recipe.meshes.files) beside_recipe(file);
    for (const std::string& text : overrides) core::apply_override(recipe, text);
    validate(recipe, path + ": ");
    return recipe;
}

}  // namespace apps
