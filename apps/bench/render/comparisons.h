// SPDX-License-Identifier: MIT
#pragma once

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
    std::string method;
    int effort = 0;
    double seconds_per_frame = 0.0;
    double rel_mse = 0.0;
    double trimmed_rel_mse = 0.0;
    double planes_rel_mse = 0.0;
    double meshes_rel_mse = 0.0;
    double accepted_share = 0.0;
    std::vector<double> rel_mse_of_frames;

    // Not written: per pixel, the absolute error's mean over the settled frames as a share of the
    // reference's mean, which outliers spoil less than squares; and the frames of the first seed.
    std::vector<float> error_map;
    SequenceFrames frames;
};

template <class Visitor>
void for_each_field(MethodComparison& method, Visitor&& visit) {
    visit("method", method.method, "estimator and how it reuses paths");
    visit("effort", method.effort, "paths drawn per pair and frame, as its time allows");
    visit(
        "seconds_per_frame", method.seconds_per_frame, "CPU time of a frame [s], the first aside");
    visit("rel_mse", method.rel_mse, "mean over the settled frames");
    visit("trimmed_rel_mse", method.trimmed_rel_mse, "the same without the worst 0.2 % of values");
    visit("planes_rel_mse",
          method.planes_rel_mse,
          "in pixels whose light bounces off large facets first");
    visit("meshes_rel_mse",
          method.meshes_rel_mse,
          "in pixels whose light bounces off small facets first");
    visit("accepted_share", method.accepted_share, "of shifts; 0: none was tried");
    visit("rel_mse_of_frames", method.rel_mse_of_frames, "frame by frame");
}

/// What is compared, and how the methods did.
struct Comparison {
    std::string name;
    std::string scene;
    double seconds_per_frame = 0.0;
    int first_settled_frame = 0;
    std::vector<MethodComparison> methods;

    // Not written.
    SequenceCase sequence;
    core::PinholeCamera camera;
    std::array<SequenceFrames, 2> references;
};

template <class Visitor>
void for_each_field(Comparison& comparison, Visitor&& visit) {
    visit("name", comparison.name, "which figure");
    visit("scene", comparison.scene, "scene description");
    visit("seconds_per_frame", comparison.seconds_per_frame, "CPU time each method was given [s]");
    visit("first_settled_frame", comparison.first_settled_frame, "means are taken from here on");
    visit("methods", comparison.methods, "one after the other, on one thread");
}

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
