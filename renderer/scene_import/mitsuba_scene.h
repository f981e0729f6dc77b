// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene_import/scene_import.h"

#include <string>

namespace renderer {

/// Translates Mitsuba's dictionary of a scene that mitransient renders: a rectangle with the sensor
/// nlos_capture_meter, a laser, shapes and the integrator transient_nlos_path.
///
/// scene    the dictionary, its `type` is scene
/// path     of its file, from which meshes are found
/// throws   core::Error naming file and key
/// source   [Royo2022], [Jakob2022]
ImportedScene import_mitsuba(const core::Json& scene, const std::string& path);

}  // namespace renderer
