// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"

#include <string>
#include <vector>

namespace apps {

/// What `third_bounce` took to 1 % of one kind of measurement.
struct ThirdBounceCost {
    std::string measurement;    ///< what was integrated to 1 %
    double cpu_seconds = 0.0;   ///< median over repeats
    double share = 0.0;         ///< of the histogram's
    double rel_l2 = 0.0;        ///< against the same to 0.2 %
    double million_rays = 0.0;  ///< rays traced [1e6]
    double tracing_rate = 0.0;  ///< while rays are traced [1e6/s]
    double whole_rate = 0.0;    ///< of the whole [1e6/s]
    /// Of Embree alone, with other rays: see shadow_ray_seconds() [1e6/s].
    double embree_rate = 0.0;
};
NLOS_FIGURES(ThirdBounceCost,
             measurement,
             cpu_seconds,
             share,
             rel_l2,
             million_rays,
             tracing_rate,
             whole_rate,
             embree_rate);

/// The scene's histogram, gates of one bin of 10 mm where 10, 50 and 90 % of its light have
/// arrived, and 16 x 16 by 16 x 16 pairs of the same wall.
std::vector<ThirdBounceCost> bench_third_bounce_costs(const std::string& scene_path, int repeats);

}  // namespace apps
