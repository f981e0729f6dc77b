// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface_probability.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

constexpr double kOddsPower = 4.0;

/// A stretch of p-values of one density.
struct Stretch {
    double width = 0.0;
    double count = 0.0;

    double density() const { return count / width; }
};

/// The falling density of greatest likelihood: neighbours between which it rises are pooled.
std::vector<Stretch> falling_density(const std::vector<double>& rising_p_values) {
    constexpr double kNarrowest = 1e-300;
    std::vector<Stretch> stretches;
    double last = 0.0;
    for (const double p : rising_p_values) {
        stretches.push_back({std::max(p - last, kNarrowest), 1.0});
        last = p;
        while (stretches.size() > 1 &&
               stretches[stretches.size() - 2].density() <= stretches.back().density()) {
            const Stretch next = stretches.back();
            stretches.pop_back();
            stretches.back().width += next.width;
            stretches.back().count += next.count;
        }
    }
    return stretches;
}

/// Mean peak of surfaces: weighted by brightness and squared probability, so that much haze does
/// not outweigh few surfaces.
double surface_brightness(const std::vector<double>& peaks,
                          const std::vector<double>& probabilities,
                          const std::vector<double>& weights) {
    double sum = 0.0;
    double weight_sum = 0.0;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        const double weight = weights[i] * probabilities[i] * probabilities[i] * peaks[i];
        sum += weight * peaks[i];
        weight_sum += weight;
    }
    return weight_sum > 0.0 ? sum / weight_sum : 0.0;
}

}  // namespace

std::vector<double> false_discovery_rates(const std::vector<double>& p_values) {
    std::vector<std::size_t> order(p_values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p_values[i]; });
    std::vector<double> rising;
    for (const std::size_t i : order) rising.push_back(p_values[i]);

    const auto count = static_cast<double>(p_values.size());
    const auto num_large = std::ranges::count_if(p_values, [](double p) { return p > 0.5; });
    const double null_share = std::min(1.0, 2.0 * static_cast<double>(num_large + 1) / count);
    std::vector<double> rates(p_values.size());
    std::size_t next = 0;
    for (const Stretch& stretch : falling_density(rising)) {
        const double rate = std::min(1.0, null_share * count / stretch.density());
        const std::size_t end = next + static_cast<std::size_t>(stretch.count);
        while (next < end) rates[order[next++]] = rate;
    }
    return rates;
}

std::vector<double> plateau_probabilities(const std::vector<double>& peaks,
                                          const std::vector<double>& weights,
                                          double edge_share) {
    constexpr int kMaxIterations = 100;
    constexpr double kTolerance = 1e-6;
    // From above: the mean of what is bright, then of what that calls a surface.
    std::vector<double> probabilities(peaks.size(), 1.0);
    double mean = surface_brightness(peaks, probabilities, weights);
    for (int i = 0; i < kMaxIterations; ++i) {
        std::ranges::transform(peaks, probabilities.begin(), [&](double peak) {
            return peak > 0.0 ? 1.0 / (1.0 + std::pow(edge_share * mean / peak, kOddsPower)) : 0.0;
        });
        const double last = mean;
        mean = surface_brightness(peaks, probabilities, weights);
        if (std::abs(mean - last) <= kTolerance * last) break;
    }
    return probabilities;
}

}  // namespace nlos
