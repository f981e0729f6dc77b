// SPDX-License-Identifier: MIT
#include "renderer/transient_accumulator.h"

#include "renderer/core/parallel.h"

#include <algorithm>

namespace renderer {

TransientAccumulator::TransientAccumulator(std::size_t num_pairs,
                                           int num_bins,
                                           int num_channels,
                                           bool variance)
    : num_pairs_(num_pairs),
      num_bins_(static_cast<std::size_t>(num_bins)),
      num_channels_(static_cast<std::size_t>(num_channels)),
      sums_(num_pairs_ * num_channels_ * num_bins_),
      squared_norms_(num_pairs_),
      squares_(variance ? num_pairs_ * num_bins_ : 0) {}

core::Transient TransientAccumulator::mean(int channel, int num_passes) const {
    core::Transient result(num_pairs_, static_cast<int>(num_bins_));
    core::parallel_for(num_pairs_, [&](std::size_t pair) {
        const double* const sums =
            sums_.data() + (pair * num_channels_ + static_cast<std::size_t>(channel)) * num_bins_;
        std::transform(sums, sums + num_bins_, result.histogram(pair).begin(), [&](double sum) {
            return static_cast<float>(sum / num_passes);
        });
    });
    return result;
}

core::Transient TransientAccumulator::mean_of_all(int num_passes) const {
    core::Transient result(num_pairs_, static_cast<int>(num_bins_));
    core::parallel_for(num_pairs_, [&](std::size_t pair) {
        const double* const sums = sums_.data() + pair * num_channels_ * num_bins_;
        for (std::size_t bin = 0; bin < num_bins_; ++bin) {
            double total = 0.0;
            for (std::size_t c = 0; c < num_channels_; ++c) total += sums[c * num_bins_ + bin];
            result.histogram(pair)[bin] = static_cast<float>(total / num_passes);
        }
    });
    return result;
}

core::Transient TransientAccumulator::variance(int num_passes) const {
    core::Transient result(num_pairs_, static_cast<int>(num_bins_));
    const double n = num_passes;
    core::parallel_for(num_pairs_, [&](std::size_t pair) {
        const double* const sums = sums_.data() + pair * num_channels_ * num_bins_;
        const double* const squares = squares_.data() + pair * num_bins_;
        for (std::size_t bin = 0; bin < num_bins_; ++bin) {
            double total = 0.0;
            for (std::size_t c = 0; c < num_channels_; ++c) total += sums[c * num_bins_ + bin];
            const double spread = std::max(0.0, squares[bin] - total * total / n);
            result.histogram(pair)[bin] = static_cast<float>(spread / (n * (n - 1.0)));
        }
    });
    return result;
}

// With x_p the estimate of pass p and m their mean, sum_p |x_p - m|^2 = sum_p |x_p|^2 - n |m|^2,
// and |known + m|^2 expects |known + H|^2 and the noise of m.
TransientAccumulator::SquaredNorms TransientAccumulator::squared_norms(
    int num_passes, const core::Transient* known) const {
    struct Sums {
        double mean = 0.0;
        double all = 0.0;
        double passes = 0.0;
        Sums& operator+=(const Sums& other) {
            mean += other.mean;
            all += other.all;
            passes += other.passes;
            return *this;
        }
    };
    const double n = num_passes;
    const Sums sums = core::parallel_sum<Sums>(num_pairs_, {}, [&](std::size_t pair) {
        Sums part{0.0, 0.0, squared_norms_[pair]};
        const double* const values = sums_.data() + pair * num_channels_ * num_bins_;
        for (std::size_t bin = 0; bin < num_bins_; ++bin) {
            double mean = 0.0;
            for (std::size_t c = 0; c < num_channels_; ++c) mean += values[c * num_bins_ + bin] / n;
            const double all = known == nullptr ? mean : mean + double{known->histogram(pair)[bin]};
            part.mean += mean * mean;
            part.all += all * all;
        }
        return part;
    });
    const double noise = std::max(0.0, sums.passes - n * sums.mean) / (n * (n - 1.0));
    return {noise, std::max(0.0, sums.all - noise)};
}

}  // namespace renderer
