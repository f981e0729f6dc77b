// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"
#include "renderer/render_result.h"
#include "renderer/scene/scene.h"

#include <functional>
#include <memory>

namespace renderer {

/// The arguments of render(), which it refers to; the settings may differ from those.
struct RenderTask {
    const Scene& scene;
    const core::Scan& scan;
    const core::HistogramAxes& axes;
    RenderSettings settings;
    const core::Progress& progress;
};

/// One frame of a sequence, ready to be rendered.
struct Frame {
    int index = 0;
    std::shared_ptr<const Scene> scene;  ///< at the time of the frame; shared while nothing moves
    core::HistogramAxes axes;            ///< with the gate of the frame
    RenderSettings settings;             ///< with the seed of the frame
};

/// Renders one frame. Frames are rendered in order; any state kept between them is its own.
using FrameRenderer =
    std::function<RenderResult(const Frame&, const core::Scan&, const core::Progress&)>;

}  // namespace renderer
