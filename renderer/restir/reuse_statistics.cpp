// SPDX-License-Identifier: MIT
#include "renderer/restir/reuse_statistics.h"

#include <algorithm>

namespace renderer {
namespace {

// What is left of a difference of two noisy sums, at least.
constexpr double kLeastPart = 1e-3;

// Relative variance of a frame, at least.
constexpr double kLeastVariance = 1e-6;

}  // namespace

void ReuseStatistics::add_shift(const PathReservoir& fresh_one,
                                const PathReservoir& past,
                                const ShiftedSample& image) {
    if (!image) return;
    const double value = image->target_value * image->jacobian * past.contribution_weight;
    covered += fresh_one.estimate() * value;
    shifted += value * value;
    shifted_per_frame += value * value / past.confidence;
}

void ReuseStatistics::add(const ReuseStatistics& others, double kept) {
    for (const auto sum : {&ReuseStatistics::candidates,
                           &ReuseStatistics::candidate_variance,
                           &ReuseStatistics::fresh,
                           &ReuseStatistics::covered,
                           &ReuseStatistics::shifted,
                           &ReuseStatistics::shifted_per_frame,
                           &ReuseStatistics::past_frames,
                           &ReuseStatistics::num_pasts}) {
        this->*sum = kept * this->*sum + others.*sum;
    }
}

double ReuseStatistics::squared_light() const {
    return std::max(candidates - candidate_variance, kLeastPart * candidates);
}

double ReuseStatistics::shift_noise() const {
    constexpr double kUnknown = 1.0;
    const double light = squared_light();
    if (!(light > 0.0) || !(shifted > 0.0)) return kUnknown;
    const double variance = std::max(fresh / light - 1.0, kLeastVariance);
    const double square = shifted / light / (1.0 + variance * shifted_per_frame / shifted);
    const double mean = std::min(1.0, covered / light);
    return std::max(0.0, square - mean * mean) / variance;
}

double ReuseStatistics::gain_of_spatial_reuse() const {
    if (!(candidates > 0.0)) return 1.0;
    const double light = squared_light();
    return (candidates - light) / std::max(fresh - light, kLeastPart * candidates);
}

}  // namespace renderer
