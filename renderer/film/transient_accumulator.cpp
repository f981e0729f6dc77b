// SPDX-License-Identifier: MIT
#include "renderer/film/transient_accumulator.h"

#include "renderer/core/parallel.h"

#include <algorithm>

namespace renderer {
namespace {

void write_row(std::span<const double> sums, int num_passes, float* to) {
    std::transform(sums.begin(), sums.end(), to, [&](double sum) {
        return static_cast<float>(sum / num_passes);
    });
}

// The rows of all pairs of `sums` in an array of the whole scan, made when the first ones come.
std::span<float> rows_of(core::Transient& array,
                         const core::Scan& scan,
                         std::size_t first_pair,
                         const TransientAccumulator& sums) {
    const std::size_t num_bins = sums.num_bins();
    if (array.empty()) array = core::Transient(scan.num_pairs(), static_cast<int>(num_bins));
    return array.values().subspan(first_pair * num_bins, sums.num_pairs() * num_bins);
}

void write(const TransientAccumulator& sums,
           int num_passes,
           const core::Scan& scan,
           std::size_t first_pair,
           core::Transient& mean,
           std::optional<core::Transient>& variance) {
    sums.write_mean_of_all(num_passes, rows_of(mean, scan, first_pair, sums));
    if (!sums.keeps_squares() || num_passes < 2) return;
    if (!variance) variance.emplace();
    sums.write_variance(num_passes, rows_of(*variance, scan, first_pair, sums));
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
    const double* const row = sums_.data() + pair * num_channels_ * num_bins_;
    if (num_channels_ == 1) return {row, num_bins_};
    buffer.assign(row, row + num_bins_);
    for (std::size_t c = 1; c < num_channels_; ++c) {
        for (std::size_t bin = 0; bin < num_bins_; ++bin) buffer[bin] += row[c * num_bins_ + bin];
    }
    return buffer;
}

void TransientAccumulator::write_mean(int channel, int num_passes, std::span<float> to) const {
    core::parallel_for(num_pairs_, [&](std::size_t pair) {
        const double* const sums =
            sums_.data() + (pair * num_channels_ + static_cast<std::size_t>(channel)) * num_bins_;
        write_row({sums, num_bins_}, num_passes, to.data() + pair * num_bins_);
    });
}

void TransientAccumulator::write_mean_of_all(int num_passes, std::span<float> to) const {
    core::parallel_for(num_pairs_, [&](std::size_t pair) {
        std::vector<double> buffer;
        write_row(totals(pair, buffer), num_passes, to.data() + pair * num_bins_);
    });
}

void TransientAccumulator::write_variance(int num_passes, std::span<float> to) const {
    const double n = num_passes;
    core::parallel_for(num_pairs_, [&](std::size_t pair) {
        std::vector<double> buffer;
        const std::span<const double> sums = totals(pair, buffer);
        const double* const squares = squares_.data() + pair * num_bins_;
        for (std::size_t bin = 0; bin < num_bins_; ++bin) {
            const double spread = std::max(0.0, squares[bin] - sums[bin] * sums[bin] / n);
            to[pair * num_bins_ + bin] = static_cast<float>(spread / (n * (n - 1.0)));
        }
    });
}

// With x_p the estimate of pass p and m their mean, sum_p |x_p - m|^2 = sum_p |x_p|^2 - n |m|^2,
// and |known + m|^2 expects |known + H|^2 and the noise of m.
TransientAccumulator::SquaredNorms TransientAccumulator::squared_norms(
    int num_passes, const core::Transient* precomputed) const {
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
        std::vector<double> buffer;
        const std::span<const double> values = totals(pair, buffer);
        const double mean = squared_norm(values) / (n * n);
        if (precomputed == nullptr) return Sums{mean, mean, squared_norms_[pair]};
        const std::span<const float> others = precomputed->histogram(pair);
        std::vector<double> all(num_bins_);
        for (std::size_t bin = 0; bin < num_bins_; ++bin) {
            all[bin] = double{others[bin]} + values[bin] / n;
        }
        return Sums{mean, squared_norm(all), squared_norms_[pair]};
    });
    const double noise = std::max(0.0, sums.passes - n * sums.mean) / (n * (n - 1.0));
    return {noise, std::max(0.0, sums.all - noise)};
}

void HistogramSums::write_to(core::Capture& capture, std::size_t first_pair, int num_passes) const {
    write(time, num_passes, capture.scan, first_pair, capture.transient, capture.variance);
    if (!velocity) return;
    write(*velocity,
          num_passes,
          capture.scan,
          first_pair,
          capture.velocity->values,
          capture.velocity->variance);
}

}  // namespace renderer
