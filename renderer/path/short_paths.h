// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/film/pass_histogram.h"
#include "renderer/path/surface_walk.h"

namespace renderer {

/// Adds orders 1 and 2 of a wall pair, which have no vertex to be drawn; its ends stand still.
void add_short_paths(const Scene& scene,
                     const PathEndpoints& ends,
                     const RenderSettings& settings,
                     PassHistogram& histogram);

/// Adds what goes from the surface that a pixel sees straight to the light.
void add_direct_light(const PathVertex& seen,
                      const PathEndpoints& ends,
                      const SurfaceWalk& walk,
                      const RenderSettings& settings,
                      PassHistogram& histogram);

}  // namespace renderer
