// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"
#include "renderer/render_result.h"
#include "renderer/scene/scene.h"

#include <functional>
#include <memory>

namespace renderer {

/// One frame of a sequence, ready to be rendered.
struct Frame {
    int index = 0;
    std::shared_ptr<const Scene>
        scene;                 ///< objects where they are now; the same while nothing moves
    core::HistogramAxes axes;  ///< the gate where it is now
    RenderSettings settings;   ///< with a seed of the frame's own
};

/// Renders one frame. Called in order; what carries state from frame to frame owns it.
using FrameRenderer =
    std::function<RenderResult(const Frame&, const core::Scan&, const core::Progress&)>;

}  // namespace renderer
