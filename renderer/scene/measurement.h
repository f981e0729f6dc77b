// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene_file.h"

#include <string>

namespace renderer {

/// A kind of core::Scan as scene.json gives it: a row of facts and functions, which each take a
/// description that asks for this kind.
struct Measurement {
    const char* size_key;  ///< the setting by which its pairs multiply
    void (*validate)(const SceneDescription& scene, const std::string& where);
    double (*num_pairs)(const SceneDescription& scene);  ///< may be more than memory holds
    core::Scan (*make)(const SceneDescription& scene);
};

const Measurement& wall_measurement();
const Measurement& camera_measurement();
const Measurement& sensor_measurement();

/// The one that a description asks for.
const Measurement& measurement_of(const SceneDescription& scene);

/// Throws core::Error unless the wall and all numbers of a scan are within their ranges.
void validate_wall(const SceneDescription& scene, const std::string& where);

/// Takes pose and angle of view from the glTF camera that is named, if any is.
///
/// where    names the setting in messages
/// throws   core::Error naming the cameras that there are
void look_up_camera(const std::string& where, SceneDescription& scene);

}  // namespace renderer
