// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/pictures/panel.h"
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/capture/capture.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace nlos {

/// "1.2 to 1.4 m".
std::string axis_text(const core::TimeAxis& axis);

/// All light of every sensing point, the wall seen like every front view; nothing for dead points.
///
/// transient   the capture's, or a frame's
ImagePanel light_panel(const core::Capture& capture,
                       const core::Transient& transient,
                       const WallGrid& grid);

/// Bins [first, last) of every pixel, summed, as the camera sees them.
ImagePanel gated_panel(const core::PinholeCamera& camera,
                       const core::Transient& transient,
                       const std::array<std::size_t, 2>& bins);

// Images of a capture in the order of time, all on one scale.

/// Frames of a sequence, evenly spaced, with all light of each; nothing for lists of points, which
/// make no image.
///
/// most   the largest number of frames wanted, at least 2
std::vector<ImagePanel> sequence_panels(const core::Capture& capture, std::size_t most);

/// The frames of an animation: of a sequence those that sequence_panels() gives; of a capture the
/// light of a bin each, or of a few that share a frame, where there is light. Of an exhaustive scan
/// it is that of the middle lit point.
///
/// most     the largest number of frames wanted, at least 2
/// throws   core::Error for lists of points, and for a single time gate
std::vector<ImagePanel> animation_panels(const core::Capture& capture, std::size_t most);

}  // namespace nlos
