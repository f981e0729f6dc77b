// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/core/progress.h"
#include "renderer/scene/scene.h"
#include "renderer/settings/render_settings.h"

#include <cstdint>

namespace renderer {

/// Third bounces, and how well they are known.
struct ThirdBounce {
    core::Transient transient;
    double estimated_error = 0.0;  ///< relative L2 over all of H
    double squared_error = 0.0;    ///< the same, absolute, squared
    std::size_t num_elements = 0;  ///< that the surfaces were cut into
    std::uint64_t num_rays = 0;
    double tracing_seconds = 0.0;  ///< aiming and tracing them, of all threads together
    double seconds = 0.0;
    bool interrupted = false;  ///< pairs that were left got the coarsest cut, see estimated_error
};

/// Integrates the third bounce of the scene's integrable surfaces: the same bits for any seed and
/// number of threads.
///
/// Surfaces are cut into triangles small enough for the closed-form kernel of core/
/// triangle_histogram.h; facets that bins do not tell apart are merged. Every wall point finds once
/// what it sees of each element; every pair then only combines two tables. A few pairs, computed at
/// several finenesses, tell how fine is fine enough for the target.
///
/// settings   target_error; or seconds, then as fine as that time allows; laser_spot_m2; the gate
///            is a box
/// progress   asked now and then whether to stop; then pairs that are left are integrated in the
///            coarsest way, so that every pair has a result
/// returns    the radiance of order 3 that comes from surfaces with is_integrable() materials
/// throws     core::Failure when memory does not suffice
/// source     design by the authors; kernel and size rule in third_bounce_elements.cpp
ThirdBounce integrate_third_bounce(const Scene& scene,
                                   const core::Scan& scan,
                                   const core::TimeAxis& axis,
                                   const RenderSettings& settings,
                                   const core::Progress& progress);

}  // namespace renderer
