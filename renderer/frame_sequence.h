// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render_task.h"
#include "renderer/scene/scene_file.h"

namespace renderer {

/// The frame renderer of the estimator in the settings: `restir` reuses the paths of earlier
/// frames, the others render every frame independently.
///
/// scan   must outlive what is returned
FrameRenderer make_frame_renderer(const core::Scan& scan, const RenderSettings& settings);

/// The objects, moved at their velocities for `seconds`.
SceneGeometry moved_by(const Scene& scene, double seconds);

/// Renders the frames of a description; gate and objects move from frame to frame.
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
