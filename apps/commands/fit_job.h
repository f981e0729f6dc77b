// SPDX-License-Identifier: MIT
#pragma once

#include "calib/calibrate.h"
#include "calib/fit.h"

#include <string>
#include <vector>

namespace apps {

/// Puts a calibration's points and path lengths into what is fitted.
void use_calibration(const calib::AppliedCalibration& calibration, calib::FitInput& input);

/// Fits a scene as calib::fit_scene() does, and says what looks wrong about the capture too.
/// throws   also core::Error for a camera in place of a relay wall
calib::FitResult fit_input(const calib::FitInput& input, const core::Progress& progress);

/// Writes FIT.json and, beside it, FIT.scene.json, FIT.glb and FIT.png.
void write_fit(const calib::FitInput& input,
               const calib::FitResult& result,
               const std::string& fit_path);

/// Fits a model file to a capture file.
///
/// overrides     `key.path=value` texts for MODEL.json, and `capture.` for how the capture is read
/// calibration   CALIBRATION.json to apply to the capture; empty: none
/// fit_path      FIT.json; FIT.scene.json, FIT.glb and FIT.png go beside it
/// picture       where to write what FIT.png shows in another format; empty: nowhere
/// throws        core::Error, core::Failure as fit_scene() does; a fit that did not converge is
///               written and returned
calib::FitResult fit_to_file(const std::string& capture_path,
                             const std::string& model_path,
                             const std::vector<std::string>& overrides,
                             const std::string& calibration,
                             const std::string& fit_path,
                             const std::string& picture = "");

}  // namespace apps
