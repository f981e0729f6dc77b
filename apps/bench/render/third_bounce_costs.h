// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace apps {

/// What `third_bounce` took to 1 % of one kind of measurement.
struct ThirdBounceCost {
    std::string measurement;
    double cpu_seconds = 0.0;  ///< median over repeats
    double share = 0.0;        ///< of the histogram's
    double rel_l2 = 0.0;       ///< against the same to 0.2 %
    double million_rays = 0.0;
    double tracing_rate = 0.0;  ///< while rays are traced [1e6/s]
    double whole_rate = 0.0;    ///< of the whole [1e6/s]
    /// Of Embree alone, with other rays: see shadow_ray_seconds() [1e6/s].
    double embree_rate = 0.0;
};

template <class Visitor>
void for_each_field(ThirdBounceCost& cost, Visitor&& visit) {
    visit("measurement", cost.measurement, "what was integrated to 1 %");
    visit("cpu_seconds", cost.cpu_seconds, "CPU time, median over repeats [s]");
    visit("share", cost.share, "of the CPU time of the histogram");
    visit("rel_l2", cost.rel_l2, "relative L2 distance from the same to 0.2 %");
    visit("million_rays", cost.million_rays, "rays traced [1e6]");
    visit("tracing_rate", cost.tracing_rate, "rays per second while they are traced [1e6/s]");
    visit("whole_rate", cost.whole_rate, "rays per second of the whole [1e6/s]");
    visit("embree_rate",
          cost.embree_rate,
          "of Embree alone, from single wall points to places drawn by area [1e6/s]");
}

/// The scene's histogram, gates of one bin of 10 mm where 10, 50 and 90 % of its light have
/// arrived, and 16 x 16 by 16 x 16 pairs of the same wall.
std::vector<ThirdBounceCost> bench_third_bounce_costs(const std::string& scene_path, int repeats);

}  // namespace apps
