// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/render/sequences.h"
#include "renderer/core/progress.h"
#include "renderer/core/settings.h"

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
    core::Json figures;            ///< a row of the table
    std::vector<float> error_map;  ///< per pixel, the absolute error's mean over the settled frames
                                   ///< as a share of the reference's mean, which outliers spoil
                                   ///< less than squares
    SequenceFrames frames;         ///< of the first seed
};

/// What is compared, and how the methods did.
struct Comparison {
    SequenceCase sequence;
    std::vector<MethodComparison> methods;  ///< one after the other, on one thread
    core::Json figures;
    core::PinholeCamera camera;
    std::array<SequenceFrames, 2> references;
};

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
