// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/scatter_fit.h"
#include "renderer/core/capture.h"

#include <optional>
#include <vector>

namespace nlos {

/// Light that came from the lit point of the wall to the sensing point with nothing in between.
struct DirectReturn {
    double offset_m = 0.0;    ///< by which it is later than the geometry has it
    std::size_t end_bin = 0;  ///< of the capture: from here on it has faded
};

/// A capture's direct return, known by what nothing hidden does: in nearly every histogram the
/// brightest bin is equally late against |l - s| plus device legs, far brighter than all that
/// follows, and most of the other light follows.
///
/// ambient   background per bin of every pair
/// returns   nothing when there is none
std::optional<DirectReturn> find_direct_return(const core::Capture& capture,
                                               const std::vector<double>& ambient);

/// At most 100 histograms, spread over the scanned points, in at most 48 bins that hold the first
/// 95 % of their light from `first_bin` on. Radiance is scaled to a mean of 20 per bin.
///
/// returns   nothing for fewer than 9 pairs or 8 bins, and in the dark
std::optional<HistogramSample> sample_histograms(const core::Capture& capture,
                                                 const std::vector<double>& ambient,
                                                 std::size_t first_bin);

}  // namespace nlos
