// SPDX-License-Identifier: MIT
#include "renderer/scene/scene_file.h"

#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/process.h"
#include "renderer/scene/measurement.h"
#include "renderer/scene/sensor_settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace renderer {
namespace {

using core::Error;
using core::require;
using core::Vec3;

void validate_geometry(const SceneDescription& scene, const std::string& where) {
    const auto refuse = [&](const char* key) {
        throw Error(where + key,
                    scene.geometry.empty()
                        ? "found without geometry"
                        : "found together with " +
                              std::filesystem::path(scene.geometry).filename().string(),
                    "must stand beside an .obj, .ply or .stl file; glTF is in metres, with y up");
    };
    if (!is_mesh_file(scene.geometry)) {
        if (scene.geometry_unit_m) refuse("geometry_unit_m");
        if (scene.geometry_up) refuse("geometry_up");
    }
    if (scene.geometry_unit_m) {
        core::check_range(*scene.geometry_unit_m, {.low = 0.0}, where + "geometry_unit_m");
    }
    validate(scene.objects, where + "objects");
}

void require_geometry(const SceneDescription& scene, const std::string& where) {
    const auto has_mesh = [](const auto& entry) { return entry.second.mesh.has_value(); };
    if (!scene.geometry.empty() ||
        std::any_of(scene.objects.begin(), scene.objects.end(), has_mesh)) {
        return;
    }
    throw Error(where + "geometry",
                "found nothing",
                "must name a .glb, .gltf, .obj, .ply or .stl file, unless objects have meshes");
}

// Refuses scans whose histograms alone could not be held, before anything is allocated.
void validate_size(const SceneDescription& scene, const std::string& where) {
    const Measurement& measurement = measurement_of(scene);
    const double pairs = measurement.num_pairs(scene);
    const double available = static_cast<double>(core::available_memory_bytes());
    const auto& [columns, rows] = scene.ground_truth.depth_resolution;
    const double depth_map_bytes = sizeof(double) * static_cast<double>(columns) * rows;
    if (depth_map_bytes > available) {
        throw Error(where + "ground_truth.depth_resolution",
                    fmt::format("found {} x {}", columns, rows),
                    fmt::format("must fit into {:.1f} GB of memory", available * 1e-9));
    }
    double values = pairs * scene.time_axis.num_bins * (scene.frames ? scene.frames->count : 1);
    if (scene.velocity_axis) {
        const double time_bins = scene.velocity_axis->with_time ? scene.time_axis.num_bins : 1.0;
        const double per_pair = scene.velocity_axis->num_bins * time_bins;
        require(per_pair <= std::numeric_limits<int>::max(),
                where + "velocity_axis with_time: values per pair",
                per_pair,
                fmt::format("at most {}", std::numeric_limits<int>::max()));
        values += pairs * per_pair;
    }
    if (values * sizeof(float) > available) {
        throw Error(where + measurement.size_key + " and time_axis.num_bins",
                    fmt::format("found {:.3g} values in all", values),
                    fmt::format("must fit into {:.1f} GB of memory", available * 1e-9));
    }
}

// A camera measures instead of wall and scan; a file that names both means something else.
void refuse_two_setups(const core::Json& keys, const std::string& where) {
    if (!keys.contains("camera") || keys["camera"].is_null()) return;
    for (const char* other : {"relay_wall", "scan"}) {
        if (!keys.contains(other)) continue;
        throw Error(where + "camera",
                    fmt::format("found together with {}", other),
                    "must stand instead of relay_wall and scan");
    }
}

// Puts a length that is given in picoseconds in place of the one in metres; `key` is without unit.
void take_picoseconds(const core::Json& json,
                      const std::string& key,
                      std::optional<double>& picoseconds,
                      double& metres) {
    if (!picoseconds) return;
    const std::string in_metres = key.substr(key.rfind('.') + 1) + "_m";
    if (json.contains(in_metres)) {
        throw Error(key + "_ps", "found together with " + in_metres, "must be one of them");
    }
    core::check_range(*picoseconds, {}, key + "_ps");
    metres = core::opl_from_seconds(1e-12 * *picoseconds);
    picoseconds.reset();
}

// Widths of bins come first: they decide what else is automatic.
void sort_axis_overrides(std::vector<std::string>& overrides) {
    const auto is_width = [](const std::string& text) {
        return text.starts_with("time_axis.bin_width_");
    };
    std::ranges::stable_partition(overrides, is_width);
    for (const char* length : {"bin_width", "opl_start"}) {
        const auto has = [&](const char* unit) {
            return std::ranges::any_of(overrides, [&](const std::string& text) {
                return text.starts_with(fmt::format("time_axis.{}_{}=", length, unit));
            });
        };
        if (!has("m") || !has("ps")) continue;
        throw Error(fmt::format("--set time_axis.{}_ps", length),
                    fmt::format("found together with {}_m", length),
                    "must be one of them");
    }
}

}  // namespace

void read_value(const core::Json& json, const std::string& where, SceneTimeAxis& axis) {
    if (json == "auto") {
        axis = {};
        axis.automatic = true;
        return;
    }
    if (!json.is_object()) {
        core::throw_wrong_type(where, json, "auto, or an object with named fields");
    }
    core::read_value<SceneTimeAxis>(json, where, axis);
    const bool has_width_ps = axis.bin_width_ps.has_value();
    const bool has_start_ps = axis.opl_start_ps.has_value();
    take_picoseconds(json, where + ".bin_width", axis.bin_width_ps, axis.bin_width_m);
    take_picoseconds(json, where + ".opl_start", axis.opl_start_ps, axis.opl_start_m);
    const bool has_width = has_width_ps || json.contains("bin_width_m");
    if (has_width_ps || (axis.automatic && has_width)) {
        axis.automatic = true;
        axis.stated = {.bin_width = true};
    }
    axis.stated.opl_start |= has_start_ps || json.contains("opl_start_m");
    axis.stated.num_bins |= json.contains("num_bins");
    axis.automatic &= axis.stated.bin_width && !(axis.stated.opl_start && axis.stated.num_bins);
    if (!axis.automatic) axis.stated = {};
}

core::Json write_value(const SceneTimeAxis& axis) {
    core::Json json = core::write_value(static_cast<const core::TimeAxis&>(axis));
    if (!axis.automatic) return json;
    if (!axis.stated.bin_width) return "auto";
    core::Json stated{{"bin_width_ps", 1e12 * axis.bin_width_m / core::kSpeedOfLight}};
    if (axis.stated.opl_start) stated["opl_start_m"] = json["opl_start_m"];
    if (axis.stated.num_bins) stated["num_bins"] = json["num_bins"];
    return stated;
}

SceneDescription read_scene_description(const std::string& path,
                                        std::vector<std::string> overrides) {
    SceneDescription scene;
    sort_axis_overrides(overrides);
    core::Json keys = core::read_json_file(path);
    core::read_value(keys, path + ": ", scene);
    const std::string folder = std::filesystem::path(path).parent_path().string();
    if (scene.scan.sensor) read_sensor(folder, path + ": scan.sensor", *scene.scan.sensor);
    for (const std::string& text : overrides) {
        core::apply_override(scene, text);
        keys.update(core::parse_override(text));
    }
    refuse_two_setups(keys, path + ": ");
    require_geometry(scene, path + ": ");
    scene.folder = folder;
    if (!scene.geometry.empty()) {
        scene.geometry = (std::filesystem::path(folder) / scene.geometry).string();
    }
    look_up_camera(path + ": camera", scene);
    look_up_sensor(folder, path + ": ", keys, scene);
    validate(scene, path + ": ");
    return scene;
}

void change_description(SceneDescription& scene, const core::Json& changes) {
    core::read_value(changes, "", scene);
    refuse_two_setups(changes, "");
    if (changes.contains("camera")) look_up_camera("camera", scene);
    look_up_sensor("", "", {{"time_axis", nullptr}}, scene);
    validate(scene, "");
}

void validate(const SceneDescription& scene, const std::string& where) {
    validate_geometry(scene, where);
    measurement_of(scene).validate(scene, where);
    core::validate(scene.time_axis, where + "time_axis");
    if (scene.detector) core::check_ranges(*scene.detector, where + "detector");
    if (scene.velocity_axis) core::validate(*scene.velocity_axis, where + "velocity_axis");
    if (scene.frames) core::check_ranges(*scene.frames, where + "frames");
    validate(scene.render, where + "render");
    core::check_ranges(scene.ground_truth, where + "ground_truth");
    validate_size(scene, where);
    require(
        scene.time_axis.num_bins == 1 || scene.render.gate == GateShape::Box,
        where + "render.gate",
        fmt::format("{} for {} bins", core::enum_name(scene.render.gate), scene.time_axis.num_bins),
        "box unless time_axis.num_bins is 1");
}

void refer_to_gltf(const std::string& file_name, SceneDescription& scene) {
    scene.geometry = file_name;
    scene.geometry_unit_m.reset();
    scene.geometry_up.reset();
    scene.objects.clear();
}

}  // namespace renderer
