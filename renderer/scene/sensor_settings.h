// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene_file.h"

#include <string>

namespace renderer {

/// Replaces a sensor that is named by what its description says; leaves others as they are.
///
/// folder   that relative names of files start from
/// where    names the setting in messages
/// throws   core::Error naming file and key, or the known names
void read_sensor(const std::string& folder, const std::string& where, SensorSettings& sensor);

/// Throws core::Error unless a scan has a sensor with a pose if and only if its pattern says so.
void validate_sensor(const ScanSettings& scan, const std::string& where);

/// Throws core::Error unless a sensor that moves has a pose per frame.
void validate_poses(const SceneDescription& scene, const std::string& where);

}  // namespace renderer
