// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/reconstruction.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/progress.h"

namespace nlos {

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
