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

/// What `nlos fit` is asked to do; empty paths: nothing.
struct FitRequest {
    std::string capture;
    std::string model;                   ///< MODEL.json
    std::vector<std::string> overrides;  ///< `key.path=value` texts for MODEL.json, and `capture.`
                                         ///< for how the capture is read
    std::string fit;                     ///< FIT.json; FIT.scene.json, .glb and .png go beside it
    std::string calibration{};           ///< CALIBRATION.json to apply to the capture
    std::string picture{};               ///< what FIT.png shows, in another format
};

/// Fits a model file to a capture file.
///
/// throws   core::Error, core::Failure as fit_scene() does; a fit that did not converge is written
///          and returned
calib::FitResult fit_to_file(const FitRequest& request);

}  // namespace apps
