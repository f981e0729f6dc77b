// SPDX-License-Identifier: MIT
#include "apps/file_kind.h"

#include "calib/fit_file.h"
#include "calib/track/track_file.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "renderer/core/file_suffix.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/mesh_file/mesh_file.h"

#include <algorithm>
#include <array>
#include <filesystem>

namespace apps {

namespace {

/// Any of these, which captures of others do not have, makes a scene.
constexpr std::array kSceneKeys{
    "geometry", "objects", "relay_wall", "scan", "camera", "time_axis", "render"};

bool holds_lists(const core::Json& json) {
    return json.is_array() ||
           (json.is_object() && std::ranges::any_of(json, [](const core::Json& member) {
                return holds_lists(member);
            }));
}

FileKind kind_of_json(const std::string& path) {
    const core::Json json = core::read_json_file(path);
    const auto has = [&](const char* a, const char* b) {
        return json.is_object() && json.contains(a) && json.contains(b);
    };
    if (calib::is_fit_file(path)) return FileKind::Fit;
    if (has("depth_mae_m", "rel_l2")) return FileKind::Metrics;
    if (calib::is_track(json)) return FileKind::Track;
    if (has("scene", "free")) return FileKind::Model;
    if (has("direct_returns", "commands")) return FileKind::Setup;
    if (has("points_m", "opl_offset_m")) return FileKind::Calibration;
    if (has("scene", "grid") || has("headline", "runs")) return FileKind::Sweep;
    const bool is_scene = json.is_object() && std::ranges::any_of(kSceneKeys, [&](const char* key) {
                              return json.contains(key);
                          });
    return is_scene || !holds_lists(json) ? FileKind::Scene : FileKind::Capture;
}

}  // namespace

FileKind kind_of_file(const std::string& path) {
    if (!std::filesystem::exists(path)) {
        throw core::Error(path,
                          "does not exist",
                          "must be a capture, volume, fit, scene.json, glTF, OBJ, PLY or STL file");
    }
    if (std::filesystem::is_directory(path)) return FileKind::Capture;
    const std::string suffix = core::file_suffix(path);
    if (suffix == ".json") return kind_of_json(path);
    if (suffix == ".ply") return FileKind::PointCloud;
    if (suffix == ".glb" || suffix == ".gltf" || renderer::is_mesh_file(path)) {
        return FileKind::Geometry;
    }
    return nlos::is_volume_file(path) ? FileKind::Volume : FileKind::Capture;
}

}  // namespace apps
