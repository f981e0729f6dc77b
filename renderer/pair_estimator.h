// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/ellipsoidal/ellipsoidal_tracer.h"
#include "renderer/path/path_tracer.h"

#include <functional>

namespace renderer {

/// Adds the contributions of `num_samples` paths of a pair (of a pixel, for cameras) to a
/// histogram, so that their sum estimates H; returns the number of rays traced.
///
/// rng   owned by this pair and pass
using PairEstimator = std::function<std::uint64_t(
    std::size_t pair, int num_samples, core::Rng& rng, PassHistogram& histogram)>;

/// Path tracing. Scene and scan must outlive the estimator, here and below.
PairEstimator path_estimator(const Scene& scene,
                             const core::Scan& scan,
                             const RenderSettings& settings,
                             ThirdBounceScope scope);

/// Ellipsoidal connections together with path tracing.
PairEstimator ellipsoidal_estimator(const Scene& scene,
                                    const core::Scan& scan,
                                    const core::TimeAxis& axis,
                                    const RenderSettings& settings,
                                    ConnectionScope scope);

}  // namespace renderer
