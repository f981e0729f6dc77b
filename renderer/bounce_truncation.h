// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render_task.h"

namespace renderer {

/// How many bounce orders are worth computing.
struct BounceTruncation {
    int last = 3;           ///< higher orders together stay below what is allowed
    double left_out = 0.0;  ///< their relative L2 over all of H: two sigma above the estimate
    double share = 0.0;     ///< of all light, that is theirs: the estimate
};

/// Estimates by a short run of path tracing on some pairs how much of H the last orders hold, and
/// drops as many of them as together stay below `allowed`.
///
/// allowed   relative L2 over all of H
BounceTruncation find_bounce_truncation(const RenderTask& task, double allowed);

}  // namespace renderer
