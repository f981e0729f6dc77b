// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/progress.h"
#include "renderer/scene/scene.h"
#include "renderer/settings/render_settings.h"
#include "renderer/third_bounce/surface_subdivider.h"

#include <cstdint>
#include <optional>

namespace renderer {

/// Third bounces, and how well they are known.
struct ThirdBounce {
    core::Transient transient;
    std::optional<double> estimated_error;  ///< relative L2 over all of H; empty: not estimated
    double squared_error = 0.0;             ///< the same, absolute, squared; 0 where not estimated
    double element_tolerance = 0.0;         ///< of the cut that was used
    std::size_t num_elements = 0;           ///< of the subdivided surfaces
    std::uint64_t num_rays = 0;
    double tracing_seconds = 0.0;  ///< for aiming and tracing them, summed over all threads
    double seconds = 0.0;
    bool is_too_much = false;  ///< the work, see CutLimits; there is no result
    bool interrupted = false;  ///< the remaining pairs got the coarsest level, see estimated_error
};

/// Integrates the third bounce of the scene's integrable surfaces: the same bits for any seed and
/// number of threads.
///
/// Surfaces are subdivided into triangles small enough for the closed-form kernel of
/// triangle_histogram.h; facets that the bins do not resolve are merged. Visibility is found once
/// for every wall point and element; every pair then only combines two tables. Pilot runs of a few
/// pairs at several refinement levels find the coarsest level that meets the target.
///
/// settings   target_error; or element_tolerance, for no pilot runs but one of a few pairs; or
///            seconds, for the finest level that this time allows; laser_spot_m2; the gate is a box
/// progress   asked now and then whether to stop; the remaining pairs are then integrated at the
///            coarsest level, so that every pair has a result
/// limits     of elements; surfaces are cut and integrated in batches, which bounds the memory
///            to about 0.5 kB for each element of a batch: a million, or as many as the scene has
///            facets. A cut may have 64 million. Batches are added in single precision, and shadow
///            edges at their borders are found from fewer neighbours
/// returns    the radiance of order 3 that comes from surfaces with is_integrable() materials
/// throws     core::Failure when memory does not suffice
/// source     design by the authors; kernel in triangle_histogram.cpp, size rule in
///            surface_subdivider.cpp
ThirdBounce integrate_third_bounce(const Scene& scene,
                                   const core::WallScan& scan,
                                   const core::TimeAxis& axis,
                                   const RenderSettings& settings,
                                   const core::Progress& progress,
                                   const CutLimits& limits = {});

}  // namespace renderer
