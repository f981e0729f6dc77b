// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/pass_render.h"
#include "renderer/path/path_tracer.h"

namespace renderer {

/// Renders by path tracing alone; results are those of render().
RenderResult render_by_paths(const RenderTask& task);

/// Traces paths of scans from order 3 on and of images, and adds orders 1 and 2 of scans.
///
/// scope     which third bounces paths compute, beside all higher orders
/// render    render_passes() or render_smoothed()
/// returns   `precomputed` counts in its error and is not among its values
RenderResult trace_paths(const RenderTask& task,
                         ThirdBounceScope scope,
                         const PrecomputedPart& precomputed,
                         RenderResult (*render)(const RenderTask&, const PassWork&));

}  // namespace renderer
