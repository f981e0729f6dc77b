// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/pass_render.h"

namespace renderer {

/// Renders with ellipsoidal connections; results are those of render().
///
/// With excluded surfaces dropped, a warning says what fraction of the signal is lost, see
/// warn_of_dropped_signal().
RenderResult render_ellipsoidal(const RenderTask& task);

/// The same with the third bounces of `scope` alone beside all higher orders, as trace_paths().
RenderResult trace_connections(const RenderTask& task,
                               ThirdBounceScope scope,
                               const PrecomputedPart& precomputed,
                               RenderResult (*render)(const RenderTask&, const PassWork&));

/// The signal of the excluded surfaces, by path tracing them alone.
struct DroppedSignal {
    double lost = 0.0;   ///< sum over the measured pairs and all bins
    double sigma = 0.0;  ///< standard deviation of `lost`
    std::vector<std::size_t> pairs;
};

/// Estimates it on at most `max_pairs` pairs, spread over the scan.
///
/// samples   of paths, per pair and each of 16 passes, whose spread gives sigma
DroppedSignal measure_dropped_signal(const RenderTask& task, std::size_t max_pairs, int samples);

/// Whether objects of which something is excluded can be lit at all: a plane wall is not lit by the
/// spots on it, and lacks no signal when it is dropped.
bool can_be_lit(const ExcludedObjects& excluded, const Scene& scene, const core::Scan& scan);

/// Which surfaces connections end on, in words.
std::string surfaces_kept(const RenderSettings& settings, const ExcludedObjects& excluded);

/// With excluded surfaces dropped, warns of the fraction of the signal that is lost where there may
/// be any, estimated on some of the pairs by a few paths for every hundred that were rendered.
///
/// result   with the capture and what was excluded
void warn_of_dropped_signal(const RenderTask& task, const RenderResult& result);

}  // namespace renderer
