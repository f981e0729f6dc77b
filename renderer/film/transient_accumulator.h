// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/film/pass_histogram.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
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

    std::size_t num_pairs() const { return num_pairs_; }
    std::size_t num_bins() const { return num_bins_; }
    bool keeps_squares() const { return !squares_.empty(); }

    /// Writes the mean over passes of one channel; `to` is [pair][bin], as below.
    void write_mean(int channel, int num_passes, std::span<float> to) const;
    /// Writes the mean over passes of the sum of all channels.
    void write_mean_of_all(int num_passes, std::span<float> to) const;
    /// Writes the variance of that mean; needs two passes and sums of squares.
    void write_variance(int num_passes, std::span<float> to) const;

    /// Squared L2 norms over all pairs and bins.
    struct SquaredNorms {
        double noise = 0.0;   ///< expected, of the mean of all channels about H
        double signal = 0.0;  ///< of `known` + H
    };
    /// Estimates both from the spread of at least two passes, without the arrays of squares.
    ///
    /// known   what is to be added to H from elsewhere, of its shape; null: nothing
    SquaredNorms squared_norms(int num_passes, const core::Transient* precomputed) const;

 private:
    template <class Double>
    static auto array(Double* begin, std::size_t size) {
        using Array =
            std::conditional_t<std::is_const_v<Double>, const Eigen::ArrayXd, Eigen::ArrayXd>;
        return Eigen::Map<Array>(begin, static_cast<Eigen::Index>(size));
    }

    // Has the same bits wherever the values lie: Eigen's sums over arrays start at aligned ones.
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

    // Sums of all channels of a pair: of a single one its own row, else in `buffer`.
    std::span<const double> totals(std::size_t pair, std::vector<double>& buffer) const;

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

    /// Writes the means, and the variances where there are squares of two passes, to the rows of a
    /// capture that begin with `first_pair`. Arrays that are still empty get their shape from the
    /// capture's scan; of velocities the axis must be there.
    void write_to(core::Capture& capture, std::size_t first_pair, int num_passes) const;

    TransientAccumulator time;
    std::optional<TransientAccumulator> velocity;  ///< with a velocity axis
};

}  // namespace renderer
