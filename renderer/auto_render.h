// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render_task.h"

namespace renderer {

/// Integrates third bounces where it can and traces paths for what is left, by ellipsoidal
/// connections where little of the light falls within the time axis. With a target_error it
/// may leave out the last orders, and average those from order 4 on over neighbours; results are
/// those of render().
RenderResult render_auto(const RenderTask& task);

/// Integrates third bounces and traces no path; results are those of render().
RenderResult render_third_bounce(const RenderTask& task);

}  // namespace renderer
