// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "renderer/core/progress.h"

#include <string>
#include <vector>

namespace apps {

/// What one estimator costs at growing size of one kind, all else equal.
struct RenderScaling {
    std::string method;                 ///< estimator
    std::string of;                     ///< what grows
    std::vector<double> sizes;          ///< sizes
    std::vector<double> cpu_seconds;    ///< CPU time at each, with threads elapsed time [s]
    std::vector<double> limit_seconds;  ///< that of as many shadow rays alone; with threads the
                                        ///< first time over their number [s]
    std::vector<double> peak_bytes;     ///< largest memory of the process at each [B]
    double exponent = 0.0;  ///< time grows with this power of the size, fitted to all points
    double last = 0.0;      ///< the same between the two largest sizes
};
NLOS_FIGURES(
    RenderScaling, method, of, sizes, cpu_seconds, limit_seconds, peak_bytes, exponent, last);

/// Scaling of `third_bounce` (to 2 %) and of `path` (256 samples per pair) with triangles (512 to
/// 500,000), wall points, bins, bounces (`path` and `restir` on shared points) and threads (all
/// three): a wavy sheet of 0.8 m, 1 m behind a wall of 1 m, confocal. One thread but for the last.
std::vector<RenderScaling> bench_render_scaling(const core::Progress& progress);

}  // namespace apps
