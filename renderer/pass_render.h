// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/film/stopping_rule.h"
#include "renderer/path/tracer.h"
#include "renderer/render_task.h"

namespace renderer {

/// What render_passes() is asked for besides the settings.
struct PassWork {
    std::shared_ptr<const Tracer> tracer;  ///< null: no paths are traced
    PrecomputedPart precomputed;           ///< of H, for its error and when to stop

    /// Memory for running sums [bytes]. Passes go over all pairs at once when their sums fit;
    /// larger scans are traced tile by tile, with the same result.
    double max_sums_bytes = 1e9;

    bool adds_short_paths = true;  ///< orders 1 and 2 of scans
    bool is_even = false;          ///< see plan_passes()
};

/// Renders by Monte Carlo, in passes over all pairs of a tile, and adds orders 1 and 2 of scans,
/// which need no sampling. Results are those of render().
///
/// throws   core::Failure as render() does, also when a scan of more than one tile is interrupted,
///          since some pairs would have no result
RenderResult render_passes(const RenderTask& task, const PassWork& work);

/// Throws core::Failure unless the memory that `what` need is free.
void require_memory(const std::string& where, const std::string& what, double bytes);

/// A dark capture of a scan, with the bounce orders that the settings ask for.
core::Capture empty_capture(const core::Scan& scan,
                            const core::HistogramAxes& axes,
                            const RenderSettings& settings);

}  // namespace renderer
