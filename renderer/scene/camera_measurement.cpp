// SPDX-License-Identifier: MIT
#include "renderer/core/settings/settings_json.h"
#include "renderer/gltf/gltf.h"
#include "renderer/mesh_file/mesh_file.h"
#include "renderer/scene/measurement.h"

#include <fmt/core.h>

namespace renderer {
namespace {

using core::Error;

void validate_image(const SceneDescription& scene, const std::string& where) {
    core::validate(*scene.camera, where + "camera");
    core::require(!scene.camera->light_spot_m || scene.render.max_bounces >= 2,
                  where + "render.max_bounces",
                  fmt::format("{} with camera.light_spot_m", scene.render.max_bounces),
                  "at least 2: the lit spot counts as a bounce");
}

}  // namespace

const Measurement& camera_measurement() {
    static const Measurement row{
        "camera.resolution",
        validate_image,
        [](const SceneDescription& scene) {
            return static_cast<double>(scene.camera->num_pixels());
        },
        [](const SceneDescription& scene) -> core::Scan { return core::ImageScan{*scene.camera}; }};
    return row;
}

void read_value(const core::Json& json, const std::string& where, CameraSettings& camera) {
    if (json.is_string()) {
        camera.name = json.get<std::string>();
    } else {
        core::read_value<CameraSettings>(json, where, camera);
    }
}

void look_up_camera(const std::string& where, SceneDescription& scene) {
    if (!scene.camera || scene.camera->name.empty()) return;
    CameraSettings& camera = *scene.camera;
    if (scene.geometry.empty() || is_mesh_file(scene.geometry)) {
        throw Error(
            where, "found \"" + camera.name + "\"", "must be an object: the geometry is no glTF");
    }
    std::string known;
    for (const Camera& candidate : load_gltf(scene.geometry).cameras) {
        known += (known.empty() ? "" : ", ") + candidate.name;
        if (candidate.name != camera.name && candidate.lens_name != camera.name) continue;
        camera.position_m = candidate.position;
        camera.look_at_m = candidate.position + candidate.forward;
        camera.up = candidate.up;
        camera.fov_y_deg = candidate.fov_y_rad * core::kDegreesPerRadian;
        return;
    }
    throw Error(where,
                fmt::format("found \"{}\"", camera.name),
                known.empty() ? scene.geometry + " must have perspective cameras"
                              : "must be one of " + known);
}

}  // namespace renderer
