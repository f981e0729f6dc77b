// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/film/pass_histogram.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
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
        using Values = std::span<const double>;
        double* const sums = sums_.data() + pair * num_channels_ * num_bins_;
        histogram.drain(
            [&](std::size_t begin, Values values) {
                array(sums + begin, values.size()) += array(values.data(), values.size());
            },
            [&](std::size_t begin, Values totals) {
                squared_norms_[pair] += squared_norm(totals);
                if (squares_.empty()) return;
                const auto all = array(totals.data(), totals.size());
                array(squares_.data() + pair * num_bins_ + begin, totals.size()) += all.square();
            });
    }

    /// Drops all passes.
    void reset() {
        for (std::vector<double>* values : {&sums_, &squared_norms_, &squares_})
            std::ranges::fill(*values, 0.0);
    }

    /// Writes the mean over passes of the sum of all channels, and its variance where there are
    /// squares of two passes, to the rows of a whole scan's arrays that begin with `first_pair`.
    void write(int num_passes,
               std::size_t first_pair,
               core::Transient& mean,
               std::optional<core::Transient>& variance) const;
    /// Likewise the mean of one channel.
    void write_channel(int channel,
                       int num_passes,
                       std::size_t first_pair,
                       core::Transient& mean) const;

    /// Squared L2 norms over all pairs and bins.
    struct SquaredNorms {
        double noise = 0.0;   ///< expected, of the mean of all channels about H
        double signal = 0.0;  ///< of `precomputed` + H
    };
    /// Estimates both from the spread of at least two passes, without the arrays of squares.
    ///
    /// precomputed   what is to be added to H from elsewhere, of its shape; null: nothing
    SquaredNorms squared_norms(int num_passes, const core::Transient* precomputed) const;

 private:
    static Eigen::Map<Eigen::ArrayXd> array(double* begin, std::size_t size) {
        return {begin, static_cast<Eigen::Index>(size)};
    }
    static Eigen::Map<const Eigen::ArrayXd> array(const double* begin, std::size_t size) {
        return {begin, static_cast<Eigen::Index>(size)};
    }

    // Eigen's sums depend on the alignment of the values; this one has the same bits for any.
    static double squared_norm(std::span<const double> values) {
        constexpr std::size_t kParts = 8;
        std::array<double, kParts> parts{};
        std::size_t i = 0;
        for (; i + kParts <= values.size(); i += kParts) {
            for (std::size_t k = 0; k < kParts; ++k) parts[k] += values[i + k] * values[i + k];
        }
        for (std::size_t k = 0; i < values.size(); ++i, ++k) parts[k] += values[i] * values[i];
        return std::accumulate(parts.begin(), parts.end(), 0.0);
    }

    std::span<const double> row(std::size_t pair, int channel) const {
        const std::size_t index = pair * num_channels_ + static_cast<std::size_t>(channel);
        return {sums_.data() + index * num_bins_, num_bins_};
    }
    // Sums of all channels of a pair: of a single one its own row, else in `buffer`.
    std::span<const double> totals(std::size_t pair, std::vector<double>& buffer) const;
    template <class WriteRow>
    void write_rows(std::size_t first_pair,
                    core::Transient& array,
                    const WriteRow& write_row) const;

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

    void reset() {
        time.reset();
        if (velocity) velocity->reset();
    }

    /// Writes means and variances to a capture, see TransientAccumulator::write(), and the means of
    /// the bounce orders that it lists. Its arrays must be there.
    void write_to(core::Capture& capture, std::size_t first_pair, int num_passes) const;

    TransientAccumulator time;
    std::optional<TransientAccumulator> velocity;  ///< with a velocity axis
};

}  // namespace renderer
