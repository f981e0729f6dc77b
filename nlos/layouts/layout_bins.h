// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "nlos/layouts/layout_histograms.h"
#include "renderer/core/capture/capture.h"

#include <vector>

namespace nlos {

/// The axis of path lengths that a layout states for `count` bins.
core::TimeAxis read_axis(const LayoutFiles& files,
                         const LayoutBins& bins,
                         std::size_t count,
                         const CaptureReadSettings& settings);

/// Whole bins by which each pair's histogram starts late.
/// Throws core::Error unless the array holds one finite delay for each histogram.
std::vector<int> read_delays(const LayoutFiles& files,
                             const LayoutShift& shift,
                             const HistogramArray& histograms,
                             const PairNumbers& numbers);

/// Moves every histogram by its delay towards bin 0. Bins that this leaves open were not observed.
void take_off_delays(const std::vector<int>& delays, core::Capture& capture);

/// The bins between the first and the last that is not 0 in all histograms.
core::BinRange lit_bins(const core::Capture& capture);

}  // namespace nlos
