// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/scene/scene.h"
#include "renderer/settings/render_settings.h"

namespace renderer {

/// How far bounces are worth computing.
struct BounceTruncation {
    int last = 3;           ///< orders above it are below what is allowed
    double left_out = 0.0;  ///< relative L2 of all of H in them: measured, and two deviations
};

/// Measures by a short run of path tracing on some pairs how much of H the last orders hold, and
/// leaves out as many of them as together stay below `allowed`.
///
/// axes       of H
/// settings   max_bounces, gate, seed
/// allowed    relative L2 over all of H
BounceTruncation find_bounce_truncation(const Scene& scene,
                                        const core::Scan& scan,
                                        const core::HistogramAxes& axes,
                                        const RenderSettings& settings,
                                        double allowed);

}  // namespace renderer
