// SPDX-License-Identifier: MIT
#pragma once

#include "calib/calibrate.h"
#include "renderer/core/progress.h"
#include "renderer/render_result.h"
#include "renderer/scene/scene.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// The estimators that ran, as in "third_bounce + path".
std::string estimator_names(const renderer::RenderResult& result);

/// What is rendered.
struct RenderInput {
    std::string scene_name;                  ///< for messages and provenance
    renderer::SceneDescription description;  ///< validated
    core::Scan scan;
    std::shared_ptr<const renderer::Scene> scene;            ///< set up for the scan
    std::optional<calib::AppliedCalibration> calibration{};  ///< of the device that records
};

/// Puts the points of a calibrated set-up in the place of the scan's, before its scene is set up.
/// throws   core::Error when the scan cannot be one of that set-up
void use_calibration(calib::AppliedCalibration calibration, RenderInput& input);

/// Renders what a scene file or a caller asks for: chooses a time axis that is left open, says
/// where the light lies, records with the calibrated device, and notes what it did in the
/// capture's `scene_info`.
///
/// progress   told what looks wrong, each once; `scene_info` keeps it
/// throws   core::Error, core::Failure as the entry points do
renderer::RenderResult render_input(RenderInput input, const core::Progress& progress);

/// Renders a scene file into a capture file that carries settings, seed, version and command line;
/// beside the image of a camera goes a preview (.png).
///
/// calibration_path   CALIBRATION.json whose points, path lengths and response the capture gets;
///                    empty: none
/// throws   core::Error, core::Failure as the entry points do
renderer::RenderResult render_to_file(const std::string& scene_path,
                                      const std::vector<std::string>& overrides,
                                      const std::string& capture_path,
                                      const std::string& calibration_path = "");

}  // namespace apps
