// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/film/pass_histogram.h"
#include "renderer/path/path_vertex.h"

namespace renderer {

/// Adds orders 1 and 2 of a wall pair, which have no vertex to sample; its ends are at rest.
void add_short_paths(const Scene& scene,
                     const PathEndpoints& ends,
                     const RenderSettings& settings,
                     PassHistogram& histogram);

}  // namespace renderer
