// SPDX-License-Identifier: MIT
#include "renderer/scene/measurement.h"

namespace renderer {

const Measurement& measurement_of(const SceneDescription& scene) {
    if (scene.camera) return camera_measurement();
    return scene.scan.pattern.of_sensor ? sensor_measurement() : wall_measurement();
}

void validate_wall(const SceneDescription& scene, const std::string& where) {
    core::validate(scene.relay_wall, where + "relay_wall");
    core::check_ranges(scene.scan, where + "scan");
}

core::Scan make_scan(const SceneDescription& scene) {
    return measurement_of(scene).make(scene);
}

}  // namespace renderer
