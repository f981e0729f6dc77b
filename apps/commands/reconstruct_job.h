// SPDX-License-Identifier: MIT
#pragma once

#include "apps/capture_options.h"
#include "nlos/reconstruct.h"

#include <string>
#include <vector>

namespace apps {

/// What `--set` of reconstruct reaches.
using ReconstructOptions = WithCapture<nlos::ReconstructSettings>;

/// What `nlos reconstruct` is asked to do; empty paths: nothing.
struct ReconstructRequest {
    std::vector<std::string> captures;   ///< one, or the frames of a sequence
    std::vector<std::string> overrides;  ///< `key.path=value` texts for ReconstructOptions
    std::string volume;                  ///< VOLUME.h5; VOLUME.png goes beside it
    std::string ply{};                   ///< the surface points
    std::string glb{};                   ///< the surface as a mesh
    std::string picture{};               ///< what VOLUME.png shows, in another format
    std::string calibration{};           ///< CALIBRATION.json to apply to the capture
};

/// Reconstructs a capture file into a volume file and what goes beside it.
/// throws   also core::Failure when a mesh was asked for and no surface was found
nlos::Reconstruction reconstruct_to_file(const ReconstructRequest& request);

}  // namespace apps
