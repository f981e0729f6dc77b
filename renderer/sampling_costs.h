// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/path/tracer.h"
#include "renderer/render_task.h"

#include <algorithm>
#include <cmath>

namespace renderer {

/// What sampling costs: squared relative error over all of H times CPU time [s], which stays the
/// same however long it runs; infinite where a pilot run saw no light.
struct SamplingCosts {
    double by_paths = 0.0;
    double by_connections = 0.0;  ///< of paths by their length
    bool may_connect = false;     ///< not where velocities are told apart

    /// Also where neither saw light: connections at least look for it within the axis.
    bool connects() const {
        return may_connect && (by_connections < by_paths || std::isinf(by_paths));
    }
    double least() const { return std::min(by_paths, by_connections); }
};

/// Finds them by some hundred samples of some of the pairs. Times are counted, not measured, so
/// that what is chosen by them is the same on any machine, for any seed and number of threads.
///
/// scope   of the third bounces that are sampled beside all higher orders
SamplingCosts find_sampling_costs(const RenderTask& task, ThirdBounceScope scope);

}  // namespace renderer
