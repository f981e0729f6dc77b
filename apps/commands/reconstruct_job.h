// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/formats/capture_file.h"
#include "nlos/reconstruct.h"

#include <string>
#include <vector>

namespace apps {

/// What `--set` of reconstruct reaches: the method's settings, and `capture.` for the file.
struct ReconstructOptions {
    nlos::ReconstructSettings reconstruct;
    nlos::CaptureReadSettings capture;
};

template <class Visitor>
void for_each_field(ReconstructOptions& options, Visitor&& visit) {
    for_each_field(options.reconstruct, visit);
    visit("capture", options.capture, "what the capture file leaves open");
}

/// Reconstructs a capture file into a volume file and the picture beside it.
///
/// capture_paths   one, or the frames of a sequence
/// overrides   `key.path=value` texts for ReconstructOptions
/// ply_path    where to write the surface points; empty: nowhere
/// glb_path    where to write the surface as a mesh; empty: nowhere
/// calibration_path   CALIBRATION.json to apply to the capture; empty: none
/// throws      also core::Failure when a mesh was asked for and no surface was found
nlos::Reconstruction reconstruct_to_file(const std::vector<std::string>& capture_paths,
                                         const std::vector<std::string>& overrides,
                                         const std::string& volume_path,
                                         const std::string& ply_path,
                                         const std::string& glb_path = "",
                                         const std::string& calibration_path = "");

}  // namespace apps
