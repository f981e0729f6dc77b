// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/canvas/canvas.h"
#include "nlos/pictures/panel.h"

namespace nlos {

/// Throws core::Error when a panel has no values or not as many as its size says.
void check_panel(const Panel& panel);

/// The room a panel takes, with title, axes and colour bar [pixels].
PixelSize panel_size(const Panel& panel);

/// Draws a panel whose upper left corner is (x, y) [pixels].
void draw_panel(Canvas& canvas, int x, int y, const Panel& panel);

}  // namespace nlos
