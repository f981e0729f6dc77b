// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface_probability.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

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

/// Sums over columns for the mean peak of surfaces: weighted by brightness and squared probability,
/// so that much haze does not outweigh few surfaces.
struct SurfaceMean {
    double sum = 0.0;
    double weight_sum = 0.0;

    void add(double peak, double weight, double probability) {
        const double own = weight * probability * probability * peak;
        sum += own * peak;
        weight_sum += own;
    }
    double value() const { return weight_sum > 0.0 ? sum / weight_sum : 0.0; }
};

/// 1 / (1 + (share mean / peak)^power), for peaks that are positive.
///
/// power_of   raises to the power
template <class PowerOf>
double plateau_probability(double peak, double share_of_mean, const PowerOf& power_of) {
    return peak > 0.0 ? 1.0 / (1.0 + power_of(share_of_mean / peak)) : 0.0;
}

/// Odds among neighbours, to the power of 12.
double power_around(double odds) {
    const double cubed = odds * odds * odds;
    return (cubed * cubed) * (cubed * cubed);
}

constexpr int kMaxIterations = 100;
constexpr double kTolerance = 1e-6;

/// Against all surfaces. From above: the mean of what is bright, then of what that calls a surface.
std::vector<double> probabilities_among_all(const std::vector<double>& peaks,
                                            const std::vector<double>& weights,
                                            const PlateauShares& shares) {
    std::vector<double> probabilities(peaks.size(), 1.0);
    double last = 0.0;
    for (int i = 0; i < kMaxIterations; ++i) {
        SurfaceMean mean;
        for (std::size_t k = 0; k < peaks.size(); ++k) {
            mean.add(peaks[k], weights[k], probabilities[k]);
        }
        if (std::abs(mean.value() - last) <= kTolerance * last) break;
        last = mean.value();
        std::ranges::transform(peaks, probabilities.begin(), [&](double peak) {
            return plateau_probability(peak, shares.dimmest * last, [&](double odds) {
                return std::pow(odds, shares.power);
            });
        });
    }
    return probabilities;
}

/// Mean peak of the surfaces among a column and its neighbours.
double mean_around(std::size_t column,
                   std::size_t num_y,
                   const std::vector<double>& peaks,
                   const std::vector<double>& weights,
                   const std::vector<double>& probabilities) {
    const std::size_t ix = column / num_y;
    const std::size_t iy = column % num_y;
    const std::size_t num_x = peaks.size() / num_y;
    SurfaceMean mean;
    for (std::size_t jx = ix - std::min<std::size_t>(ix, 1); jx < std::min(num_x, ix + 2); ++jx) {
        for (std::size_t jy = iy - std::min<std::size_t>(iy, 1); jy < std::min(num_y, iy + 2);
             ++jy) {
            const std::size_t j = jx * num_y + jy;
            mean.add(peaks[j], weights[j], probabilities[j]);
        }
    }
    return mean.value();
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
                                          std::size_t num_y,
                                          const PlateauShares& shares) {
    const std::vector<double> among_all = probabilities_among_all(peaks, weights, shares);
    std::vector<double> probabilities = among_all;
    for (int i = 0; i < kMaxIterations; ++i) {
        std::vector<double> next(peaks.size());
        double change = 0.0;
        for (std::size_t column = 0; column < peaks.size(); ++column) {
            const double mean = mean_around(column, num_y, peaks, weights, probabilities);
            next[column] = among_all[column] *
                           plateau_probability(peaks[column], shares.edge * mean, power_around);
            change = std::max(change, std::abs(next[column] - probabilities[column]));
        }
        probabilities = std::move(next);
        if (change <= kTolerance) break;
    }
    return probabilities;
}

}  // namespace nlos
