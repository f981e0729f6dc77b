// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/left_out_orders.h"
#include "renderer/ellipsoidal/excluded_facets.h"
#include "renderer/film/scan_smoothing.h"
#include "renderer/restir/restir_counts.h"
#include "renderer/settings/render_settings.h"

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
    std::vector<OrderSource> sources;             ///< orders 1 and 2 need no estimator
    std::optional<double> estimated_error;        ///< relative L2 over all of H; empty: not known
    std::optional<double> element_tolerance;      ///< of third bounces, see RenderSettings
    std::optional<core::LeftOutOrders> left_out;  ///< counts as part of the error
    std::optional<SmoothingWidths> smoothing;     ///< of what paths gave; its bias likewise
    std::uint64_t samples_per_pair = 0;           ///< candidate paths used, whole passes
    std::uint64_t num_rays = 0;
    double seconds = 0.0;
    ExcludedObjects excluded;    ///< from ellipsoidal connections, when there are any
    RestirCounts restir_counts;  ///< of restir
    bool interrupted = false;    ///< stopped early; every pair has a result
};

}  // namespace renderer
