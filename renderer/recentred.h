// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render_task.h"

#include <optional>

namespace renderer {

/// By how much a scene has to be moved to the world's origin, where double precision resolves much
/// finer than what the estimators compare [m]; nothing where it does not lie far off beside its
/// size, so that it is rendered as it stands.
///
/// center        of the scene [m]
/// half_size_m   how far from there it reaches
std::optional<core::Vec3> way_to_origin(const core::Vec3& center, double half_size_m);

/// Renders frames near the world's origin.
///
/// make      makes what renders them, from the scan there
/// returns   what renders frames where they stand; the scan must outlive it
FrameRenderer make_recentred_frame_renderer(const core::Scan& scan,
                                            const RenderSettings& settings,
                                            FrameRenderer (*make)(const core::Scan& scan,
                                                                  const RenderSettings& settings));

}  // namespace renderer
