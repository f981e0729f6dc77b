// SPDX-License-Identifier: MIT
#include "apps/bench/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace apps {

PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y) {
    const double n = static_cast<double>(x.size());
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mean_x += std::log(x[i]) / n;
        mean_y += std::log(y[i]) / n;
    }
    double xx = 0.0;
    double xy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double offset = std::log(x[i]) - mean_x;
        xx += offset * offset;
        xy += offset * (std::log(y[i]) - mean_y);
    }
    const double exponent = xx > 0.0 ? xy / xx : 0.0;
    return {std::exp(mean_y - exponent * mean_x), exponent};
}

Estimate estimate_of(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double squares = 0.0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return {mean, count > 1.0 ? std::sqrt(squares / (count - 1.0) / count) : 0.0};
}

ErrorSums errors_of(const core::Transient& x, const core::Transient& a, const core::Transient& b) {
    constexpr double kTrimmedFraction = 0.002;
    ErrorSums sums;
    std::vector<double> squares;
    for (std::size_t i = 0; i < x.values().size(); ++i) {
        const double vx = double{x.values()[i]};
        const double va = double{a.values()[i]};
        const double vb = double{b.values()[i]};
        squares.push_back((vx - va) * (vx - vb));
        sums.reference += va * vb;
        sums.sum += vx;
        sums.reference_sum += 0.5 * (va + vb);
    }
    const auto kept =
        static_cast<std::ptrdiff_t>(static_cast<double>(squares.size()) * (1.0 - kTrimmedFraction));
    std::nth_element(squares.begin(), squares.begin() + kept, squares.end());
    for (std::size_t i = 0; i < squares.size(); ++i) {
        sums.squared += squares[i];
        if (static_cast<std::ptrdiff_t>(i) < kept) sums.trimmed += squares[i];
    }
    return sums;
}

void SequenceErrors::add(std::span<const core::Transient> frames,
                         std::span<const core::Transient> a,
                         std::span<const core::Transient> b) {
    for (std::size_t f = 0; f < of_frames_.size(); ++f) {
        of_frames_[f] += errors_of(frames[f], a[f], b[f]);
    }
}

std::vector<double> SequenceErrors::rel_mse_of_frames() const {
    std::vector<double> result;
    for (const ErrorSums& frame : of_frames_) result.push_back(frame.rel_mse());
    return result;
}

ErrorSums SequenceErrors::settled(std::size_t first_frame) const {
    ErrorSums sums;
    for (std::size_t f = first_frame; f < of_frames_.size(); ++f) sums += of_frames_[f];
    return sums;
}

}  // namespace apps
