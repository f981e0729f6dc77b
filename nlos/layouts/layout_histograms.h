// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/layout_match.h"
#include "nlos/layouts/layout_points.h"
#include "renderer/core/capture/capture.h"

#include <optional>
#include <vector>

namespace nlos {

/// Which entries along the point axes belong to which pair of a scan.
struct PairNumbers {
    core::ScanPattern pattern = core::ScanPattern::Confocal;
    std::size_t num_sensing = 0;
    std::vector<std::size_t> sensing;       ///< point of each sensing entry
    std::vector<std::size_t> illumination;  ///< of each illumination entry, likewise
    bool listed = false;                    ///< entries are pairs: both lists run along one axis

    std::size_t pair(std::size_t illumination_entry, std::size_t sensing_entry) const {
        if (pattern != core::ScanPattern::Exhaustive) return sensing[sensing_entry];
        const std::size_t lit = illumination[listed ? sensing_entry : illumination_entry];
        return lit * num_sensing + sensing[sensing_entry];
    }
};

struct Histograms {
    std::vector<core::Transient> frames;
    std::vector<core::Transient> by_order;  ///< along the axis `order`; they sum to the last frame
};

/// Reads the histograms of every frame. Axes that name neither points, bins, frames nor orders of
/// bounces are summed; orders are summed as well as kept.
///
/// frame     the only frame to read; nothing: all of them
/// returns   one transient per frame, and per order where there are several
/// throws    core::Error when an array is cut short or does not fit in memory
Histograms read_histograms(const LayoutFiles& files,
                           const HistogramArray& array,
                           const PairNumbers& numbers,
                           std::size_t num_pairs,
                           std::optional<int> frame);

/// Subtracts the mean of some histograms, which have the bins of the transient, from all of its.
/// Throws core::Error when one has another number of bins.
void subtract_background(const LayoutFiles& files,
                         const std::vector<std::string>& background,
                         core::Transient& transient);

}  // namespace nlos
