// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/frame.h"
#include "renderer/scene/scene_file.h"

#include <memory>

namespace renderer {

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
