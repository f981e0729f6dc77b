// SPDX-License-Identifier: MIT
#include "renderer/film/transient_accumulator.h"

#include "renderer/core/system/parallel.h"

#include <algorithm>

namespace renderer {
namespace {

void write_mean(std::span<const double> sums, int num_passes, std::span<float> to) {
    std::transform(sums.begin(), sums.end(), to.begin(), [&](double sum) {
        return static_cast<float>(sum / num_passes);
    });
}

}  // namespace

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

std::span<const double> TransientAccumulator::totals(std::size_t pair,
                                                     std::vector<double>& buffer) const {
    const std::span<const double> first = row(pair, 0);
    if (num_channels_ == 1) return first;
    buffer.assign(first.begin(), first.end());
    for (int c = 1; c < static_cast<int>(num_channels_); ++c) {
        const std::span<const double> values = row(pair, c);
        for (std::size_t bin = 0; bin < num_bins_; ++bin) buffer[bin] += values[bin];
    }
    return buffer;
}

template <class WriteRow>
void TransientAccumulator::write_rows(std::size_t first_pair,
                                      core::Transient& array,
                                      const WriteRow& write_row) const {
    core::parallel_for(
        num_pairs_, [&](std::size_t pair) { write_row(pair, array.histogram(first_pair + pair)); });
}

void TransientAccumulator::write_channel(int channel,
                                         int num_passes,
                                         std::size_t first_pair,
                                         core::Transient& mean) const {
    write_rows(first_pair, mean, [&](std::size_t pair, std::span<float> to) {
        write_mean(row(pair, channel), num_passes, to);
    });
}

void TransientAccumulator::write(int num_passes,
                                 std::size_t first_pair,
                                 core::Transient& mean,
                                 std::optional<core::Transient>& variance) const {
    write_rows(first_pair, mean, [&](std::size_t pair, std::span<float> to) {
        std::vector<double> buffer;
        write_mean(totals(pair, buffer), num_passes, to);
    });
    if (squares_.empty() || num_passes < 2) return;
    if (!variance) variance.emplace(mean.num_pairs(), static_cast<int>(num_bins_));
    const double n = num_passes;
    write_rows(first_pair, *variance, [&](std::size_t pair, std::span<float> to) {
        std::vector<double> buffer;
        const std::span<const double> sums = totals(pair, buffer);
        const double* const squares = squares_.data() + pair * num_bins_;
        for (std::size_t bin = 0; bin < num_bins_; ++bin) {
            const double spread = std::max(0.0, squares[bin] - sums[bin] * sums[bin] / n);
            to[bin] = static_cast<float>(spread / (n * (n - 1.0)));
        }
    });
}

// With x_p the estimate of pass p and m their mean, sum_p |x_p - m|^2 = sum_p |x_p|^2 - n |m|^2,
// and the expectation of |precomputed + m|^2 is |precomputed + H|^2 plus the noise of m.
TransientAccumulator::SquaredNorms TransientAccumulator::squared_norms(
    int num_passes, const core::Transient* precomputed) const {
    const double n = num_passes;
    using Sums = Eigen::Array3d;  // squares of the mean, of all and of passes
    const Sums sums = core::parallel_sum<Sums>(num_pairs_, Sums::Zero(), [&](std::size_t pair) {
        std::vector<double> buffer;
        const std::span<const double> values = totals(pair, buffer);
        const double mean = squared_norm(values) / (n * n);
        if (precomputed == nullptr) return Sums(mean, mean, squared_norms_[pair]);
        const std::span<const float> others = precomputed->histogram(pair);
        std::vector<double> all(num_bins_);
        for (std::size_t bin = 0; bin < num_bins_; ++bin) {
            all[bin] = double{others[bin]} + values[bin] / n;
        }
        return Sums(mean, squared_norm(all), squared_norms_[pair]);
    });
    const double noise = std::max(0.0, sums[2] - n * sums[0]) / (n * (n - 1.0));
    return {noise, std::max(0.0, sums[1] - noise)};
}

void HistogramSums::write_to(core::Capture& capture, std::size_t first_pair, int num_passes) const {
    time.write(num_passes, first_pair, capture.transient, capture.variance);
    for (std::size_t i = 0; i < capture.orders.size(); ++i) {
        time.write_channel(capture.orders[i] - 1, num_passes, first_pair, capture.by_order[i]);
    }
    if (!velocity) return;
    velocity->write(num_passes, first_pair, capture.velocity->values, capture.velocity->variance);
}

}  // namespace renderer
