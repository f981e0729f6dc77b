// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/plots/plot.h"

namespace nlos {

/// Throws core::Error when a line has not as many x as y.
void check(const Plot& plot);

/// The size of what the axes enclose.
PixelSize plot_size(const Plot& plot);

/// The height of the legend below the axes.
int legend_height(const Plot& plot);

/// Draws lines, axes and legend.
///
/// box   what the axes enclose
void draw_plot(Canvas& canvas, const PixelBox& box, const Plot& plot);

}  // namespace nlos
