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

/// What render_paths() is asked for beside the settings.
struct PathWork {
    PathShare share = PathShare::Everything;

    /// Memory for running sums [bytes]. Passes go over all pairs at once when their sums fit;
    /// larger scans are traced tile by tile, with the same result.
    double most_sums_bytes = 1e9;
};

/// Renders by path tracing, in passes over all pairs of a tile, and adds orders 1 and 2, which need
/// no sampling. Arguments and results are those of render().
///
/// throws   core::Failure as render() does, also when a scan of more than one tile is interrupted:
///          the tiles are not even then
RenderResult render_paths(const Scene& scene,
                          const core::Scan& scan,
                          const core::TimeAxis& axis,
                          const RenderSettings& settings,
                          const PathWork& work,
                          const core::Progress& progress);

}  // namespace renderer
