// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/gnuplot.h"
#include "apps/bench/render/comparisons.h"
#include "nlos/pictures/picture.h"

#include <vector>

namespace apps {

/// The reference's last frame, the methods' error maps on one scale, and where the first of them
/// does worse or better than the second.
///
/// comparison   of at least two methods, gates of one bin
std::vector<nlos::Panel> error_panels(const Comparison& comparison);

/// One bin of frames 1, 2, 4, ...: a row per method, the reference at its end.
std::vector<nlos::Panel> progress_panels(const Comparison& comparison);

/// Error against the number of frames.
Plot progress_plot(const Comparison& comparison);

}  // namespace apps
