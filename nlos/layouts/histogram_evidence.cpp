// SPDX-License-Identifier: MIT
#include "nlos/layouts/histogram_evidence.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

constexpr std::size_t kFewestBins = 16;

/// Sums over an array's values.
struct ValueSums {
    std::vector<std::vector<double>> light;  ///< absolute values at each index of each axis
    double sum = 0.0;
    double negative = 0.0;    ///< of the absolute values of those below 0
    double largest = 0.0;     ///< absolute value
    std::size_t strange = 0;  ///< NaN and infinities
    bool are_whole_numbers = true;
};

ValueSums sum_values(const LayoutFiles& files, const std::string& name) {
    ValueSums sums;
    const Shape shape = files.shape(name);
    for (const std::size_t extent : shape) sums.light.emplace_back(extent, 0.0);
    std::vector<std::size_t> fastest(shape.size());
    std::iota(fastest.begin(), fastest.end(), std::size_t{0});
    if (!files.first_index_fastest(name)) std::reverse(fastest.begin(), fastest.end());
    std::vector<std::size_t> index(shape.size(), 0);
    files.read_runs(name, [&](const std::vector<float>& values) {
        for (const float value : values) {
            const double size = std::abs(static_cast<double>(value));
            if (!std::isfinite(value)) {
                ++sums.strange;
            } else {
                for (std::size_t axis = 0; axis < shape.size(); ++axis) {
                    sums.light[axis][index[axis]] += size;
                }
                sums.sum += size;
                sums.negative += value < 0.0F ? size : 0.0;
                sums.largest = std::max(sums.largest, size);
                sums.are_whole_numbers &= value == std::trunc(value);
            }
            for (const std::size_t axis : fastest) {
                if (++index[axis] < shape[axis]) break;
                index[axis] = 0;
            }
        }
    });
    return sums;
}

/// Standard deviation over mean, without what Poisson noise adds to the sums of counts.
double variation_of(const std::vector<double>& light, bool are_counts) {
    const auto n = static_cast<double>(light.size());
    const double mean = std::accumulate(light.begin(), light.end(), 0.0) / n;
    if (!(mean > 0.0)) return 0.0;
    double variance = are_counts ? -mean : 0.0;
    for (const double value : light) variance += (value - mean) * (value - mean) / n;
    return std::sqrt(std::max(0.0, variance)) / mean;
}

/// Whether an array has the axes of a picture: rows and columns, and channels at most.
bool is_like_a_picture(const Shape& shape) {
    constexpr std::size_t kMostChannels = 4;
    const auto longer = std::ranges::count_if(shape, [](auto e) { return e > kMostChannels; });
    return longer == 2;
}

/// What speaks against histograms in the sums; empty: nothing.
std::string objection(const Shape& shape, const ValueSums& sums, const HistogramEvidence& found) {
    // Histograms are dark before light comes and bright for few bins; maps and photographs are
    // bright all over.
    constexpr double kBright = 0.2;  // mean over largest value
    constexpr double kBalanced = 0.2;
    if (sums.strange > 0) return fmt::format("{} values are NaN or infinite", sums.strange);
    if (!(sums.sum > 0.0)) return "all values are 0";
    if (sums.negative > kBalanced * sums.sum) return "many values are negative";
    if (!(found.variation > 0.0)) return "values vary along no axis more than noise does";
    if (shape[found.time_axis] < kFewestBins) {
        return fmt::format("values vary most along axis {}, which has no more than {} entries",
                           found.time_axis,
                           shape[found.time_axis]);
    }
    const double mean = sums.sum / static_cast<double>(total_bytes(shape, 1));
    if (is_like_a_picture(shape) && mean > kBright * sums.largest) {
        return "it is bright all over, as a map or photograph";
    }
    return "";
}

}  // namespace

HistogramEvidence weigh_as_histograms(const LayoutFiles& files, const std::string& name) {
    const Shape shape = files.shape(name);
    const ValueSums sums = sum_values(files, name);
    HistogramEvidence found;
    found.are_whole_numbers = sums.are_whole_numbers;
    for (std::size_t axis = 0; axis < shape.size(); ++axis) {
        const double variation = variation_of(sums.light[axis], sums.are_whole_numbers);
        if (variation > found.variation) {
            found.next_variation = std::exchange(found.variation, variation);
            found.time_axis = axis;
        } else {
            found.next_variation = std::max(found.next_variation, variation);
        }
    }
    found.why_not = objection(shape, sums, found);
    return found;
}

}  // namespace nlos
