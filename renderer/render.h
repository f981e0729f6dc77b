// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/core/progress.h"
#include "renderer/excluded_facets.h"
#include "renderer/render_settings.h"
#include "renderer/restir_counts.h"
#include "renderer/scene.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace renderer {

/// Which estimator computed which bounce orders, of which surfaces.
struct OrderSource {
    int first_order = 3;
    int last_order = 3;
    Estimator estimator = Estimator::Path;
    std::string surfaces = "all";
};

/// What render() computed and what it took.
struct RenderResult {
    core::Capture capture;
    std::vector<OrderSource> sources;       ///< orders 1 and 2 need no estimator
    std::optional<double> estimated_error;  ///< relative L2 over all of H; empty: not known
    std::uint64_t samples_per_pair = 0;     ///< candidate paths used, whole passes
    std::uint64_t num_rays = 0;
    double seconds = 0.0;
    ExcludedObjects excluded;  ///< from ellipsoidal connections, when there are any
    std::vector<std::string> warnings;
    RestirCounts restir_counts;  ///< of restir
    bool interrupted = false;    ///< stopped early; every pair has a result
};

/// Renders the transients that a scan, or a camera, records of a scene.
///
/// scan       wall points with unit normals, or a camera
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
