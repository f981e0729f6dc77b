// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/layout_files.h"

#include <string>

namespace nlos {

/// What the values of an array say about whether they could be histograms.
struct HistogramEvidence {
    std::string why_not;        ///< what speaks against it; empty: they could be
    std::size_t time_axis = 0;  ///< along which light varies most, in the writer's order
    double variation = 0.0;     ///< along it: standard deviation over mean of the light at an index
    double next_variation = 0.0;  ///< the largest along another axis
    bool are_whole_numbers = true;
};

/// Looks at every value of a numeric array with two axes or more.
///
/// Light varies far more from bin to bin than from point to point, where the noise of counts is
/// taken off. Maps, photographs and coordinates are told by what histograms never are: not finite,
/// as often negative as positive, most varied along an axis too short for bins, or bright all over.
HistogramEvidence weigh_as_histograms(const LayoutFiles& files, const std::string& name);

}  // namespace nlos
