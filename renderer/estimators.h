// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render_task.h"

namespace renderer {

/// How an estimator renders; what it can be asked for stands in settings/estimators.h.
struct EstimatorMethod {
    /// Renders a scan of wall points or an image. Results are those of render().
    RenderResult (*run)(const RenderTask& task) = nullptr;

    /// Makes what renders the frames of a sequence one after another; null: run() renders each of
    /// them. The scan must outlive what is returned.
    FrameRenderer (*make_frame_renderer)(const core::Scan& scan,
                                         const RenderSettings& settings) = nullptr;
};

/// Whether any hidden surface that reflects is integrable, and whether any has a narrow lobe.
struct Surfaces {
    bool integrable = false;
    bool narrow_lobes = false;
};

Surfaces surfaces_of(const Scene& scene);

const EstimatorMethod& method_of(Estimator estimator);

/// Throws core::Error unless the estimator in the settings can render the task; the error names
/// those that can.
void require_possible(const RenderTask& task);

}  // namespace renderer
