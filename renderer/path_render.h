// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/path_tracer.h"
#include "renderer/render.h"

namespace renderer {

/// Which part of the third bounce path tracing computes; it computes all higher orders.
enum class PathShare {
    Everything,     ///< all of it
    NotIntegrable,  ///< that of surfaces without is_integrable() materials
    Nothing,        ///< neither it nor higher orders: no paths are traced
};

/// Renders by path tracing, in passes over all pairs, and adds orders 1 and 2, which need no
/// sampling. Arguments, results and exceptions are those of render().
RenderResult render_paths(const Scene& scene,
                          const core::Scan& scan,
                          const core::TimeAxis& axis,
                          const RenderSettings& settings,
                          PathShare share,
                          const core::Progress& progress);

}  // namespace renderer
