// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"
#include "renderer/core/settings.h"

#include <string>
#include <vector>

namespace apps {

/// What one estimator costs at growing size of one kind, all else equal.
struct RenderScaling {
    std::string method;
    std::string of;  ///< what grows
    std::vector<double> sizes;
    std::vector<double> cpu_seconds;
    std::vector<double> limit_seconds;
    std::vector<double> peak_bytes;
    double exponent = 0.0;  ///< time grows with this power of the size, fitted to all points
    double last = 0.0;      ///< the same between the two largest sizes
};

template <class Visitor>
void for_each_field(RenderScaling& scaling, Visitor&& visit) {
    visit("method", scaling.method, "estimator");
    visit("of", scaling.of, "what grows");
    visit("sizes", scaling.sizes, "sizes");
    visit("cpu_seconds", scaling.cpu_seconds, "CPU time at each, with threads elapsed time [s]");
    visit("limit_seconds",
          scaling.limit_seconds,
          "that of as many shadow rays alone; with threads the first time over their number [s]");
    visit("peak_bytes", scaling.peak_bytes, "largest memory of the process at each [B]");
    visit("exponent", scaling.exponent, "fitted power of the size");
    visit("last", scaling.last, "power between the two largest sizes");
}

/// Scaling of `third_bounce` (to 2 %) and of `path` (256 samples per pair) with triangles (512 to
/// 500,000), wall points, bins, bounces (`path` and `restir` on shared points) and threads (all
/// three): a wavy sheet of 0.8 m, 1 m behind a wall of 1 m, confocal. One thread but for the last.
std::vector<RenderScaling> bench_render_scaling(const core::Progress& progress);

}  // namespace apps
