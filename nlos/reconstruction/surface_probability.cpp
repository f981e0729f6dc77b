// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface_probability.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
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

    static double weight_of(double peak, double weight, double probability) {
        return weight * probability * probability * peak;
    }
    void add(double peak, double weight, double probability) {
        const double own = weight_of(peak, weight, probability);
        sum += own * peak;
        weight_sum += own;
    }
    double value() const { return weight_sum > 0.0 ? sum / weight_sum : 0.0; }
};

/// How far a peak stays behind a fraction of the mean; without end where it is none.
double odds_against(double peak, double fraction_of_mean) {
    return peak > 0.0 ? fraction_of_mean / peak : std::numeric_limits<double>::infinity();
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
                                            const PlateauFractions& fractions) {
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
            return 1.0 /
                   (1.0 + std::pow(odds_against(peak, fractions.dimmest * last), fractions.power));
        });
    }
    return probabilities;
}

/// Sums over every column and its neighbours; columns stored [x][y].
std::vector<double> sums_around(const std::vector<double>& values, std::size_t num_y) {
    std::vector<double> along_y(values);
    for (std::size_t first = 0; first < values.size(); first += num_y) {
        const double* const row = values.data() + first;
        double* const sums = along_y.data() + first;
        for (std::size_t y = 1; y < num_y; ++y) sums[y] += row[y - 1];
        for (std::size_t y = 0; y + 1 < num_y; ++y) sums[y] += row[y + 1];
    }
    std::vector<double> sums(along_y);
    for (std::size_t i = 0; i + num_y < values.size(); ++i) sums[i + num_y] += along_y[i];
    for (std::size_t i = 0; i + num_y < values.size(); ++i) sums[i] += along_y[i + num_y];
    return sums;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    const auto size = static_cast<Eigen::Index>(a.size());
    if (size == 0) return 0.0;
    return (Eigen::Map<const Eigen::ArrayXd>(a.data(), size) -
            Eigen::Map<const Eigen::ArrayXd>(b.data(), size))
        .abs()
        .maxCoeff();
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
    const double null_fraction = std::min(1.0, 2.0 * static_cast<double>(num_large + 1) / count);
    std::vector<double> rates(p_values.size());
    std::size_t next = 0;
    for (const Stretch& stretch : falling_density(rising)) {
        const double rate = std::min(1.0, null_fraction * count / stretch.density());
        const std::size_t end = next + static_cast<std::size_t>(stretch.count);
        while (next < end) rates[order[next++]] = rate;
    }
    return rates;
}

std::vector<double> plateau_probabilities(const std::vector<double>& peaks,
                                          const std::vector<double>& weights,
                                          std::size_t num_y,
                                          const PlateauFractions& fractions) {
    const std::vector<double> among_all = probabilities_among_all(peaks, weights, fractions);
    std::vector<double> probabilities = among_all;
    std::vector<double> own(peaks.size());
    std::vector<double> moment(peaks.size());
    std::vector<double> next(peaks.size());
    for (int i = 0; i < kMaxIterations; ++i) {
        for (std::size_t k = 0; k < peaks.size(); ++k) {
            own[k] = SurfaceMean::weight_of(peaks[k], weights[k], probabilities[k]);
            moment[k] = own[k] * peaks[k];
        }
        const std::vector<double> weight_sums = sums_around(own, num_y);
        const std::vector<double> sums = sums_around(moment, num_y);
        for (std::size_t k = 0; k < peaks.size(); ++k) {
            const double mean = SurfaceMean{sums[k], weight_sums[k]}.value();
            next[k] =
                among_all[k] / (1.0 + power_around(odds_against(peaks[k], fractions.edge * mean)));
        }
        probabilities.swap(next);
        const double change = largest_difference(probabilities, next);
        if (change <= kTolerance) break;
    }
    return probabilities;
}

}  // namespace nlos
