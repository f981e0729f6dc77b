// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_fwd.h"
#include "renderer/scene/scene_file.h"

#include <string>

namespace renderer {

/// Replaces a sensor that is named by what its description says; leaves others as they are.
///
/// folder   that relative names of files start from
/// where    names the setting in messages
/// throws   core::Error naming file and key, or the known names
void read_sensor(const std::string& folder, const std::string& where, SensorSettings& sensor);

/// Does so for the sensor of a scene, and takes its bins where `keys`, those of scene.json, hold no
/// others.
void look_up_sensor(const std::string& folder,
                    const std::string& where,
                    const core::Json& keys,
                    SceneDescription& scene);

}  // namespace renderer
