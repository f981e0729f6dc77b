// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit.h"
#include "renderer/core/settings/json_fwd.h"

#include <string>

namespace calib {

/// FIT.json's content: values, `sigma` of the same shape, and how good they are.
core::Json fit_json(const FitResult& result);

/// The objects, points and numbers of a FIT.json, without data and model.
/// throws   core::Error when the file is something else
FitResult read_fit(const std::string& path);

/// True for a JSON file that is a fit.
bool is_fit_file(const std::string& path);

/// The fitted scene as a scene description: the model's, with the capture's points and axis.
///
/// geometry_file   name of the glTF file that goes beside it
core::Json fitted_scene_json(const FitInput& input, const std::string& geometry_file);

}  // namespace calib
