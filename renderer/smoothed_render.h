// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/pass_render.h"

namespace renderer {

/// Renders by Monte Carlo until an error is reached, as render_passes() does, and averages what was
/// sampled over neighbouring wall points and bins, as far as that lowers the error. For light that
/// varies slowly, such as bounces from order 4 on: a few samples per pair then suffice. Orders 1
/// and 2 are not averaged.
///
/// Two independent halves of the samples tell what noise is left and what averages blur. The widths
/// with the least error are taken, and both parts count in the error that is reported. Points in a
/// list are averaged over bins alone.
///
/// task   of a scan, with a target_error; neither variances nor bounce orders are asked for
RenderResult render_smoothed(const RenderTask& task, const PassWork& work);

}  // namespace renderer
