// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruct.h"
#include "renderer/scene/scene.h"

namespace apps {

/// CPU seconds of the FFTs or multiply-adds that a finished reconstruction's method could not do
/// without on this capture, run alone in cache on scratch data: the lower limit of its time on this
/// machine. 0 for methods that iterate.
double reconstruction_limit_seconds(const core::Capture& capture, const nlos::Reconstruction& done);

/// One shadow ray from a scan's points to hidden surfaces, in packets from one point to places in
/// the order of the file: the lower limit of every path of `path`. In CPU seconds.
double shadow_ray_seconds(const renderer::Scene& scene, const core::WallScan& scan);

}  // namespace apps
