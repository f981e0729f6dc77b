// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/core/progress.h"
#include "renderer/render_settings.h"
#include "renderer/scene.h"

#include <cstdint>

namespace renderer {

/// What render() computed and what it took.
struct RenderResult {
    core::Capture capture;
    Estimator estimator = Estimator::Path;  ///< the one that ran
    std::uint64_t samples_per_pair = 0;     ///< candidate paths used, whole passes
    std::uint64_t num_rays = 0;
    double seconds = 0.0;
    bool interrupted = false;  ///< stopped early; the capture is even over all pairs
};

/// Renders the transients that a scan records of a scene.
///
/// scan       wall points; unit normals
/// axis       bins of optical path length
/// settings   validated; `samples` is rounded up to whole passes
/// progress   asked after every pass whether to stop
/// returns    radiance leaving the sensing points for 1 W on the illumination point, per bin
///            (the bin's integral); its variance on request, given more than one pass
/// throws     core::Failure when memory does not suffice or a contribution is not finite
RenderResult render(const Scene& scene,
                    const core::Scan& scan,
                    const core::TimeAxis& axis,
                    const RenderSettings& settings,
                    const core::Progress& progress);

}  // namespace renderer
