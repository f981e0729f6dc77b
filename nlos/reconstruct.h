// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruct_settings.h"
#include "nlos/volume.h"
#include "renderer/core/capture.h"
#include "renderer/core/depth_map.h"
#include "renderer/core/mesh.h"
#include "renderer/core/progress.h"

#include <cstdint>
#include <string>
#include <vector>

namespace nlos {

struct Reconstruction {
    Volume volume;
    core::DepthMap depth;     ///< sub-bin depth of the brightest voxel per column; NaN = background
    core::PointCloud points;  ///< foreground of `depth` in world coordinates, normals to the wall
    std::string method;       ///< the one that ran
    std::string reason;       ///< why `auto` took it
    ReconstructSettings settings;       ///< with every choice filled in
    std::vector<std::string> warnings;  ///< what looks wrong about the capture
    core::Json provenance;              ///< who made it from what, as the caller says
    double seconds = 0.0;
    double stated_bytes = 0.0;  ///< memory on top of the capture, announced before the run
    std::uint64_t peak_bytes = 0;
};

/// Reconstructs the hidden scene from a capture. Before the work starts, `progress.announce` is
/// told the method, why it was taken and how much memory it needs.
///
/// returns   volume, depth map and points, in metres
/// throws    core::Error when the method cannot serve this capture (names one that can) or a
///           setting is out of range; core::Failure when memory does not suffice or
///           `progress` asks to stop
Reconstruction reconstruct(const core::Capture& capture,
                           const ReconstructSettings& settings,
                           const core::Progress& progress);

}  // namespace nlos
