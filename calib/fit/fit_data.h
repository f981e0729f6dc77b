// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <array>
#include <optional>
#include <vector>

namespace calib {

/// Standard deviations of blur within which what lies beyond an end of the data spoils them.
inline constexpr double kBlurReach = 2.0;

/// Data of a stage, as the residuals want it.
struct FitData {
    std::vector<double> values;  ///< [pair][bin]
    core::TimeAxis axis;
    double min_mean = 1e-12;                     ///< expected counts are kept above it
    core::ObservedBins observed = std::nullopt;  ///< of `values`; the others are 0 and do not count

    std::size_t num_pairs() const {
        return axis.num_bins > 0 ? values.size() / static_cast<std::size_t>(axis.num_bins) : 0;
    }
    core::BinRange observed_range(std::size_t pair) const {
        return core::observed_range(observed, pair, axis.num_bins);
    }
    std::size_t num_observed() const {
        return core::observed_count(observed, num_pairs(), axis.num_bins);
    }
};

/// The part of a capture's histograms whose bins lie in a window of path lengths, without bins that
/// no pair observed at either end.
FitData crop(const core::Capture& capture, const std::optional<std::array<double, 2>>& window_m);

/// Data blurred by a Gaussian and summed to wider bins.
///
/// blur_m    standard deviation in path length; 0: none
/// merged    bins that become one; a rest at the end is left out
/// returns   bins count as observed where all of them were and no blur of more than a little
/// reaches
///           them from where nobody looked
FitData coarsen(const FitData& data, double blur_m, int merged);

/// Data without some bins at the ends of the axis.
FitData trim(const FitData& data, int front, int back);

/// Whether light of the first and of the last bins stands out, so that some of it must lie beyond
/// the axis.
///
/// ambient   light per bin that does not count
std::array<bool, 2> light_is_cut(const FitData& data, double ambient);

/// Some of a scan's pairs, spread evenly over the wall.
struct PairSubset {
    core::WallScan scan;
    std::vector<std::size_t> pairs;  ///< of the whole scan, in the subset's order
};
/// At most about `most` pairs, every k-th point of each axis of a grid.
PairSubset thin(const core::WallScan& scan, std::size_t most);

/// The histograms of some pairs.
FitData select(const FitData& data, const std::vector<std::size_t>& pairs);

/// True when every value is a whole number that is not negative.
bool is_integer_valued(const core::Capture& capture);

/// Light per bin where there is least of it: a first guess of the ambient light.
double quietest_level(const FitData& data);

}  // namespace calib
