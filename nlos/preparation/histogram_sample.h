// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <optional>
#include <vector>

namespace nlos {

/// A few histograms of a capture, a few dozen bins each: enough to ask whether a geometry can be
/// true.
struct HistogramSample {
    std::vector<std::size_t> pairs;  ///< numbers in the capture
    std::size_t num_bins = 0;        ///< per histogram
    double first_bin = 0.0;          ///< of the capture, where the sample begins
    double merged_bins = 1.0;        ///< bins of the capture in one of these
    std::vector<float> values;       ///< [pair][bin], photon counts or what stands for them
    std::vector<float> observed;     ///< [pair][bin], 1 where something could be recorded, else 0
    std::vector<float> ambient;      ///< per bin of each pair
    bool has_poisson_noise = false;
};

/// The pairs that a sample holds: at most 196, spread over the scanned points.
std::vector<std::size_t> sampled_pairs(const core::WallScan& scan);

/// Light that came from the lit point of the wall to the sensing point with nothing in between.
struct DirectReturn {
    double offset_m = 0.0;              ///< by which it is later than the geometry has it
    double fading_m = 0.0;              ///< length over which it fades
    std::vector<std::size_t> end_bins;  ///< of the sampled pairs: from here on it has faded
};

/// A capture's direct return, known by what nothing hidden does: in nearly every histogram the
/// brightest bin is equally late against |l - s| plus device segments, far brighter than all that
/// follows, and most of the other light follows.
///
/// ambient   background per bin of every pair
/// returns   nothing when there is none
std::optional<DirectReturn> find_direct_return(const core::Capture& capture,
                                               const std::vector<double>& ambient);

/// Histograms of the sampled pairs, in at most 48 bins that hold nearly all of their light. Bins of
/// a direct return and those before it count as not observed. Radiance is scaled to a mean of 20
/// per bin.
///
/// returns   nothing for fewer than 9 pairs or 8 bins, and in the dark
std::optional<HistogramSample> sample_histograms(const core::Capture& capture,
                                                 const std::vector<double>& ambient,
                                                 const std::optional<DirectReturn>& direct);

}  // namespace nlos
