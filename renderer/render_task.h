// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/progress.h"
#include "renderer/scene/scene.h"
#include "renderer/settings/render_settings.h"

namespace renderer {

/// The arguments of render(), which it refers to; the settings may differ from those.
struct RenderTask {
    const Scene& scene;
    const core::Scan& scan;
    const core::HistogramAxes& axes;
    RenderSettings settings;
    const core::Progress& progress;
};

}  // namespace renderer
