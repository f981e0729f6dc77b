// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "nlos/layouts/layout_files.h"
#include "nlos/layouts/layout_points.h"
#include "renderer/core/capture/capture.h"

#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// The array of histograms of a file, with its axes as the layout names them.
struct HistogramArray {
    std::string name;
    std::vector<std::string> axes;  ///< in the writer's order
    Shape extents;
    bool reversed = false;  ///< whether they stand in reverse of the layout's order

    std::optional<std::size_t> extent(const std::string& axis) const;
};

/// Finds it. Nothing when the file holds none that fits the layout's axes.
std::optional<HistogramArray> find_histograms(const LayoutFiles& files, const Layout& layout);

/// What a file lacks to be of this layout, a few words each; nothing: it is of this layout.
std::vector<std::string> mismatches(const LayoutFiles& files, const Layout& layout);

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

/// Whether two lists hold the same points up to the single precision of files.
bool are_same_points(const core::WallPoints& a, const core::WallPoints& b);

/// Where the points are and how they pair up.
///
/// scan      its origin of path lengths and its devices are known; gets points and pattern
/// throws    core::Error when arrays are missing or do not fit the histograms, or when these do not
///           hold every pair of the pattern once
PairNumbers read_pairs(const LayoutFiles& files,
                       const Layout& layout,
                       const HistogramArray& array,
                       const CaptureReadSettings& settings,
                       core::WallScan& scan);

/// The axis of path lengths that a layout gives for `count` bins.
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
