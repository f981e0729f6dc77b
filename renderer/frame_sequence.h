// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"
#include "renderer/render_result.h"
#include "renderer/scene/scene_file.h"

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

/// The renderer of the frames that the settings ask for: `restir` carries its paths on from frame
/// to frame, the others render() every frame on its own.
///
/// scan   must outlive what is returned
FrameRenderer make_frame_renderer(const core::Scan& scan, const RenderSettings& settings);

/// Objects where they are after `seconds` at their velocities.
SceneGeometry moved_by(const Scene& scene, double seconds);

/// Renders `frames` of a description: gate and objects move on from frame to frame.
///
/// scene         the description's scene, as the first frame sees it
/// scan          as make_scan() gives it
/// returns       the last frame, with all frames beside it; the sum of all rays and seconds. When
///               interrupted: the frames that were begun
/// throws        what `render_frame` throws
RenderResult render_frames(std::shared_ptr<const Scene> scene,
                           const core::Scan& scan,
                           const SceneDescription& description,
                           const FrameRenderer& render_frame,
                           const core::Progress& progress);

}  // namespace renderer
