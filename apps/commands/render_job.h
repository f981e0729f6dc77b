// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render_result.h"

#include <string>
#include <vector>

namespace apps {

/// The estimators that ran, as in "third_bounce + path".
std::string estimator_names(const renderer::RenderResult& result);

/// Renders a scene file into a capture file that carries settings, seed, version and command line;
/// beside the image of a camera goes a preview (.png).
///
/// calibration_path   CALIBRATION.json whose points, path lengths and response the capture gets;
///                    empty: none
/// returns  what was rendered, with what the format could not keep among the warnings
/// throws   core::Error, core::Failure as the front doors do
renderer::RenderResult render_to_file(const std::string& scene_path,
                                      const std::vector<std::string>& overrides,
                                      const std::string& capture_path,
                                      const std::string& calibration_path = "");

}  // namespace apps
