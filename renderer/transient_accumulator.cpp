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

}  // namespace renderer
