// SPDX-License-Identifier: MIT
#include "nlos/methods/backprojection.h"

#include <algorithm>

namespace nlos {
namespace {

constexpr float kSmallestFraction = 0.5F;  // of the mean fraction

/// 1 in the observed bins, or in all bins.
core::Transient sight(const MethodInput& input, const std::vector<core::BinRange>* observed) {
    core::Transient ones(input.transient.num_pairs(), input.time_axis.num_bins);
    for (std::size_t pair = 0; pair < ones.num_pairs(); ++pair) {
        const core::BinRange range =
            observed ? (*observed)[pair] : core::BinRange{0, input.time_axis.num_bins};
        const auto first = ones.histogram(pair).begin() + range.begin;
        std::fill(first, first + range.size(), 1.0F);
    }
    return ones;
}

/// How many look-ups of each voxel meet the observed bins, or the axis.
std::vector<float> count_lookups(const MethodInput& input,
                                 const std::vector<core::BinRange>* observed,
                                 const core::Progress& progress,
                                 std::size_t num_slabs) {
    const core::Transient ones = sight(input, observed);
    return backproject(with_histograms(input, input.time_axis, ones, progress),
                       ReconstructSettings{},
                       num_slabs)
        .values;
}

}  // namespace

void divide_by_observed_fraction(const MethodInput& input, std::size_t num_slabs, Volume& volume) {
    const std::vector<float> all =
        count_lookups(input, nullptr, input.progress.part(1.0 / 3.0, 2.0 / 3.0), num_slabs);
    std::vector<float> fractions =
        count_lookups(input, input.observed, input.progress.part(2.0 / 3.0, 1.0), num_slabs);
    double lookups = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < fractions.size(); ++i) {
        const float seen = fractions[i];
        fractions[i] = all[i] > 0.0F ? seen / all[i] : 0.0F;
        lookups += static_cast<double>(seen);
        sum += static_cast<double>(seen) * static_cast<double>(fractions[i]);
    }
    if (!(lookups > 0.0)) return;
    const float smallest = kSmallestFraction * static_cast<float>(sum / lookups);
    for (std::size_t i = 0; i < fractions.size(); ++i) {
        volume.values[i] /= std::max(smallest, fractions[i]);
    }
}

double observed_fraction_bytes(const MethodInput& input) {
    if (!input.observed) return 0.0;
    return 4.0 * static_cast<double>(input.transient.values().size()) +
           8.0 * static_cast<double>(input.axes.num_voxels());
}

}  // namespace nlos
