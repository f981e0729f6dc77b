// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/transient.h"
#include "renderer/pass_histogram.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace renderer {

/// Sums and sums of squares of pass estimates, in double precision.
///
/// All passes have the same number of samples, so the mean over passes estimates H and their spread
/// its variance, whatever stratification a pass uses inside.
class TransientAccumulator {
 public:
    /// variance   whether to keep sums of squares
    TransientAccumulator(std::size_t num_pairs, int num_bins, int num_channels, bool variance);

    /// Adds the estimate of one pass for one pair; different pairs may be added concurrently.
    ///
    /// histogram   PassHistogram, or PassVelocityHistogram for its bins; is left empty
    template <class Histogram>
    void add_pass(std::size_t pair, Histogram& histogram) {
        double* const sums = sums_.data() + pair * num_channels_ * num_bins_;
        double* const squares = squares_.empty() ? nullptr : squares_.data() + pair * num_bins_;
        double squared_norm = 0.0;
        histogram.drain([&](std::size_t index, double value) { sums[index] += value; },
                        [&](std::size_t bin, double total) {
                            squared_norm += total * total;
                            if (squares != nullptr) squares[bin] += total * total;
                        });
        squared_norms_[pair] += squared_norm;
    }

    /// Mean over passes of one channel.
    core::Transient mean(int channel, int num_passes) const;
    /// Mean over passes of the sum of all channels.
    core::Transient mean_of_all(int num_passes) const;
    /// Variance of mean_of_all(); needs two passes and sums of squares.
    core::Transient variance(int num_passes) const;

    /// Squared L2 norms over all pairs and bins.
    struct SquaredNorms {
        double noise = 0.0;   ///< expected, of mean_of_all() about H
        double signal = 0.0;  ///< of `known` + H
    };
    /// Estimates both from the spread of at least two passes, without the arrays of squares.
    ///
    /// known   what is to be added to H from elsewhere, of its shape; null: nothing
    SquaredNorms squared_norms(int num_passes, const core::Transient* known) const;

 private:
    std::size_t num_pairs_;
    std::size_t num_bins_;
    std::size_t num_channels_;
    std::vector<double> sums_;           ///< [pair][channel][bin]
    std::vector<double> squared_norms_;  ///< [pair], summed over passes
    std::vector<double> squares_;        ///< [pair][bin] of the sum over channels; empty: not kept
};

/// The sums of all that a pass histogram collects.
struct HistogramSums {
    HistogramSums(std::size_t num_pairs,
                  const core::HistogramAxes& axes,
                  int num_channels,
                  bool variance)
        : time(num_pairs, axes.time.num_bins, num_channels, variance) {
        if (!axes.velocity) return;
        velocity.emplace(num_pairs, axes.velocity->num_values(axes.time.num_bins), 1, variance);
    }

    void add_pass(std::size_t pair, PassHistogram& histogram) {
        time.add_pass(pair, histogram);
        if (velocity) velocity->add_pass(pair, histogram.velocity());
    }

    TransientAccumulator time;
    std::optional<TransientAccumulator> velocity;  ///< with a velocity axis
};

}  // namespace renderer
