// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"
#include "renderer/render_result.h"
#include "renderer/scene/scene.h"
#include "renderer/settings/render_settings.h"

namespace renderer {

/// Renders the transients that a scan, or a camera, records of a scene.
///
/// scan       wall points with unit normals, a camera, or the zones of a sensor (sensor_render.h)
/// axes       bins of optical path length and, if asked for, of path velocity: the same light by
///            how fast its paths change their length, within the time axis
/// settings   validated; `samples` is rounded up to whole passes; method `auto` integrates third
///            bounces where it can and traces paths for what is left
/// progress   asked after every pass or part whether to stop
/// returns    radiance leaving the sensing points for 1 W on the illumination point, or reaching
///            the camera, averaged over each pixel, for a light of 1 W [W/(m^2 sr)], per bin (the
///            bin's integral); the variance of the part from paths on request, given more than
///            one pass
/// throws     core::Error when the method cannot do what is asked; core::Failure when memory does
///            not suffice or a contribution is not finite
RenderResult render(const Scene& scene,
                    const core::Scan& scan,
                    const core::HistogramAxes& axes,
                    const RenderSettings& settings,
                    const core::Progress& progress);

}  // namespace renderer
