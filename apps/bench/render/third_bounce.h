// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "renderer/core/progress.h"

#include <cstdint>
#include <string>
#include <vector>

namespace apps {

/// What became of one target error on one random scene.
struct TargetError {
    int scene = 0;               ///< number of the random scene
    std::string pattern;         ///< of the scan
    double target_error = 0.0;   ///< relative L2 error asked for
    double rel_l2 = 0.0;         ///< against the same to 0.1 %
    double stated = 0.0;         ///< what the integrator says of itself
    std::uint64_t elements = 0;  ///< that the surfaces were cut into
    bool is_coarsest = false;    ///< no coarser cut exists
    bool met = false;            ///< rel_l2 is at most the target
    bool is_far_below = false;   ///< more than five times, with a coarser cut left
};
NLOS_FIGURES(TargetError,
             scene,
             pattern,
             target_error,
             rel_l2,
             stated,
             elements,
             is_coarsest,
             met,
             is_far_below);

/// How `third_bounce` and `path` agree on a scene.
struct Agreement {
    std::string scene;           ///< scene file
    std::string pattern;         ///< of the scan
    std::uint64_t num_bins = 0;  ///< that path knows to 10 %, and their neighbours, too
    double within_95 = 0.0;      ///< share of them within their 95 % interval
    double largest_z = 0.0;      ///< largest distance in standard deviations
    double p_value = 1.0;        ///< of that among so many bins
    double energy_ratio = 0.0;   ///< third_bounce over path
    double energy_sigma = 0.0;   ///< its standard deviation
};
NLOS_FIGURES(
    Agreement, scene, pattern, num_bins, within_95, largest_z, p_value, energy_ratio, energy_sigma);

/// `third_bounce` to 5, 2 and 1 % on random scenes of spheres and parallelograms that hide and
/// touch one another, in confocal, single and exhaustive scans by turns.
std::vector<TargetError> bench_target_errors(int num_scenes, const core::Progress& progress);

/// `third_bounce` to 0.05 % against `path` bin by bin, on scenes as they are but for 16 of their
/// wall points, in confocal, single and exhaustive scans.
///
/// throws   core::Error for a scene with a camera
std::vector<Agreement> bench_agreement(const std::vector<std::string>& scenes,
                                       const core::Progress& progress);

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
