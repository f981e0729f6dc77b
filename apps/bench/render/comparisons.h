// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "apps/bench/render/sequences.h"

#include <array>
#include <string>
#include <vector>

namespace apps {

/// A method that gets as much CPU time per frame as the others.
struct ComparedMethod {
    std::string name;
    std::vector<std::string> overrides;
    std::string effort_key;  ///< setting that says how many paths a frame draws
    int most_effort = 4096;
};

/// How a method did.
struct MethodComparison {
    std::string method;              ///< estimator and how it reuses paths
    int effort = 0;                  ///< paths drawn per pair and frame, as its time allows
    double seconds_per_frame = 0.0;  ///< CPU time of a frame [s], the first aside
    double rel_mse = 0.0;            ///< mean over the settled frames
    double trimmed_rel_mse = 0.0;    ///< the same without the worst 0.2 % of values
    double planes_rel_mse = 0.0;     ///< in pixels whose light bounces off large facets first
    double meshes_rel_mse = 0.0;     ///< in pixels whose light bounces off small facets first
    double accepted_share = 0.0;     ///< of shifts; 0: none was tried
    std::vector<double> rel_mse_of_frames;  ///< frame by frame

    // Not written: per pixel, the absolute error's mean over the settled frames as a share of the
    // reference's mean, which outliers spoil less than squares; and the frames of the first seed.
    std::vector<float> error_map;
    SequenceFrames frames;
};
NLOS_FIGURES(MethodComparison,
             method,
             effort,
             seconds_per_frame,
             rel_mse,
             trimmed_rel_mse,
             planes_rel_mse,
             meshes_rel_mse,
             accepted_share,
             rel_mse_of_frames);

/// What is compared, and how the methods did.
struct Comparison {
    std::string name;                       ///< which figure
    std::string scene;                      ///< scene description
    double seconds_per_frame = 0.0;         ///< CPU time each method was given [s]
    int first_settled_frame = 0;            ///< means are taken from here on
    std::vector<MethodComparison> methods;  ///< one after the other, on one thread

    // Not written.
    SequenceCase sequence;
    core::PinholeCamera camera;
    std::array<SequenceFrames, 2> references;
};
NLOS_FIGURES(Comparison, name, scene, seconds_per_frame, first_settled_frame, methods);

/// Renders a sequence of an image by several methods at equal CPU time on one thread, and measures
/// them against two independent references.
///
/// num_seeds   runs per method
/// throws      core::Error when the scene has no camera; core::Failure when interrupted
Comparison compare_methods(const SequenceCase& sequence,
                           const std::vector<ComparedMethod>& methods,
                           double seconds_per_frame,
                           int num_seeds,
                           const core::Progress& progress);

}  // namespace apps
