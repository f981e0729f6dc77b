// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

namespace nlos {

/// What a time gate sees of a capture: a capture of one bin. A gate as long as the axis gives the
/// steady-state image. A bin that the gate covers in part counts in part. A pair that did not
/// observe all that the gate covers counts as not observed.
///
/// gate_start_m, gate_width_m   on the axis of `capture` [m of path length]; width positive
/// throws                       core::Error when the gate does not lie within the axis
core::Capture gated_capture(const core::Capture& capture, double gate_start_m, double gate_width_m);

}  // namespace nlos
