// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"
#include "renderer/core/settings.h"

#include <cstdint>
#include <string>
#include <vector>

namespace apps {

/// What became of one target error on one random scene.
struct TargetError {
    int scene = 0;  ///< number of the random scene
    std::string pattern;
    double target = 0.0;
    double rel_l2 = 0.0;         ///< against the same to 0.1 %
    double stated = 0.0;         ///< what the integrator says of itself
    std::uint64_t elements = 0;  ///< that the surfaces were cut into
    bool is_coarsest = false;    ///< no coarser cut exists
    bool met = false;            ///< rel_l2 is at most the target
    bool is_far_below = false;   ///< more than five times, with a coarser cut left
};

template <class Visitor>
void for_each_field(TargetError& error, Visitor&& visit) {
    visit("scene", error.scene, "number of the random scene");
    visit("pattern", error.pattern, "of the scan");
    visit("target_error", error.target, "relative L2 error asked for");
    visit("rel_l2", error.rel_l2, "relative L2 distance from the same to 0.1 %");
    visit("stated", error.stated, "relative L2 error as stated");
    visit("elements", error.elements, "that the surfaces were cut into");
    visit("is_coarsest", error.is_coarsest, "no coarser cut exists");
    visit("met", error.met, "the error is at most the target");
    visit("is_far_below", error.is_far_below, "over five times below it, a coarser cut is left");
}

/// How `third_bounce` and `path` agree on a scene.
struct Agreement {
    std::string scene;
    std::string pattern;
    std::uint64_t num_bins = 0;  ///< that path knows to 10 %, and their neighbours, too
    double within_95 = 0.0;      ///< share of them within their 95 % interval
    double largest_z = 0.0;      ///< largest distance in standard deviations
    double p_value = 1.0;        ///< of that among so many bins
    double energy_ratio = 0.0;   ///< third_bounce over path
    double energy_sigma = 0.0;   ///< its standard deviation
};

template <class Visitor>
void for_each_field(Agreement& agreement, Visitor&& visit) {
    visit("scene", agreement.scene, "scene file");
    visit("pattern", agreement.pattern, "of the scan");
    visit(
        "num_bins", agreement.num_bins, "bins that path knows to 10 %, and their neighbours, too");
    visit("within_95", agreement.within_95, "share of them within their 95 % interval");
    visit("largest_z", agreement.largest_z, "largest distance in standard deviations");
    visit("p_value", agreement.p_value, "chance of one so large among so many bins");
    visit("energy_ratio", agreement.energy_ratio, "of third_bounce over that of path");
    visit("energy_sigma", agreement.energy_sigma, "standard deviation of the ratio");
}

/// `third_bounce` to 5, 2 and 1 % on random scenes of spheres and parallelograms that hide and
/// touch one another, in confocal, single and exhaustive scans by turns.
std::vector<TargetError> bench_target_errors(int num_scenes, const core::Progress& progress);

/// `third_bounce` to 0.05 % against `path` bin by bin, on scenes as they are but for 16 of their
/// wall points, in confocal, single and exhaustive scans.
///
/// throws   core::Error for a scene with a camera
std::vector<Agreement> bench_agreement(const std::vector<std::string>& scenes,
                                       const core::Progress& progress);

}  // namespace apps
