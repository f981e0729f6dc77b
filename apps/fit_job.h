// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit.h"
#include "nlos/formats/picture.h"

#include <string>
#include <vector>

namespace apps {

/// Fits a model file to a capture file.
///
/// overrides        `key.path=value` texts for MODEL.json
/// calibration      CALIBRATION.json to apply to the capture; empty: none
/// fit_path         FIT.json; FIT.scene.json, FIT.glb and FIT.png go beside it
/// throws           core::Error, core::Failure as fit_scene() does; a fit that did not converge is
///                  written and returned
calib::FitResult fit_to_file(const std::string& capture_path,
                             const std::string& model_path,
                             const std::vector<std::string>& overrides,
                             const std::string& calibration,
                             const std::string& fit_path);

/// Data, model and their difference in standard deviations, a row per wall point.
std::vector<nlos::Panel> fit_panels(const calib::FitResult& result);

}  // namespace apps
