// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "apps/bench/output.h"

#include <string>
#include <vector>

namespace apps {

/// Whether stated deviations of depth hold, at one signal level.
struct DepthCoverage {
    std::string method;
    double peak_counts = 0.0;  ///< expected counts in the brightest bin
    int captures = 0;
    std::size_t columns = 0;  ///< of true surfaces that were given a depth
    double within_68 = 0.0;   ///< share of them within one deviation of the truth
    double within_95 = 0.0;   ///< within 1.96
    double inside_68 = 0.0;   ///< the same of columns that only surface surrounds
    double inside_95 = 0.0;
    double median_sigma_m = 0.0;
    double median_error_m = 0.0;
    double found = 0.0;        ///< share of true columns given a depth
    double wrong = 0.0;        ///< share of background columns given one
    double wrong_apart = 0.0;  ///< of those that no true column touches
};
NLOS_FIGURES(DepthCoverage,
             method,
             peak_counts,
             captures,
             columns,
             within_68,
             within_95,
             inside_68,
             inside_95,
             median_sigma_m,
             median_error_m,
             found,
             wrong,
             wrong_apart);

/// How many of the columns with a stated probability within a tenth are surface.
struct ProbabilityReliability {
    std::string method;
    double from = 0.0;        ///< stated probability, to 0.1 more
    std::size_t columns = 0;  ///< with it, of all signal levels
    double stated = 0.0;      ///< their mean probability
    double surface = 0.0;     ///< share of them that are surface
};
NLOS_FIGURES(ProbabilityReliability, method, from, columns, stated, surface);

struct CoverageBench {
    std::vector<DepthCoverage> depths;
    std::vector<ProbabilityReliability> probabilities;
};
NLOS_FIGURES(CoverageBench, depths, probabilities);

/// What `nlos bench coverage` is to measure.
struct CoverageBenchSettings {
    int surfaces = 60;  ///< each at every signal level
    int first = 1000;   ///< number of the first
    std::vector<std::string> methods{"lct", "dlct", "fk", "phasor", "fbp", "bp"};
    std::vector<double> peaks{3.0, 10.0, 20.0, 100.0, 1000.0};
};

/// Reconstructs random surfaces from counts and holds stated deviations and probabilities against
/// the truth.
CoverageBench cover(const CoverageBenchSettings& settings, const core::Progress& progress);

}  // namespace apps
