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

}  // namespace nlos
