// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene_file.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// What a finished render has to say about itself.
struct RenderJob {
    std::size_t num_pairs = 0;
    int num_bins = 0;
    std::size_t num_frames = 0;  ///< 0: no sequence
    std::string pattern;
    std::string estimator;
    std::uint64_t samples_per_pair = 0;     ///< 0 when no paths were traced
    std::optional<double> estimated_error;  ///< relative L2 over all of H, when known
    double seconds = 0.0;
    bool interrupted = false;
    std::vector<std::string> warnings;
    core::Json details;  ///< what the capture says of the run, settings aside
};

/// Renders a scene file into a capture file that carries settings, seed, version and command line;
/// beside the image of a camera goes a preview (.png).
///
/// calibration_path   CALIBRATION.json whose points, path lengths and response the capture gets;
///                    empty: none
/// throws   core::Error, core::Failure as the front doors do
RenderJob render_to_file(const std::string& scene_path,
                         const std::vector<std::string>& overrides,
                         const std::string& capture_path,
                         const std::string& calibration_path = "");

}  // namespace apps
