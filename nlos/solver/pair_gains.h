// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace nlos {

/// Factors by which the light of every pair (or confocal point) differs from what the model makes
/// of the scene: reflectance of the wall there, efficiency of the detector. Before any light is
/// seen a factor is 1 with a standard deviation of 0.3; their mean stays 1, as the scene's albedo
/// takes up a common one.
class PairGains {
 public:
    explicit PairGains(std::size_t num_pairs) : factors_(num_pairs, 1.0F) {}

    const std::vector<float>& factors() const { return factors_; }
    float operator[](std::size_t pair) const { return factors_[pair]; }

    /// The factors that explain measurements best, given a scene.
    ///
    /// measured   per pair, the sum over its observed bins of light (background taken off) times
    ///            what the scene makes of the bin for a factor of 1, over the bin's variance
    /// expected   per pair, the same of what the scene makes of the bin instead of the light
    void update(const std::vector<double>& measured, const std::vector<double>& expected) {
        constexpr double kPriorWeight = 1.0 / (0.3 * 0.3);
        constexpr double kSmallest = 0.02;  // a dead point
        for (std::size_t pair = 0; pair < factors_.size(); ++pair) {
            const double factor = (measured[pair] + kPriorWeight) / (expected[pair] + kPriorWeight);
            factors_[pair] = static_cast<float>(std::max(kSmallest, factor));
        }
        const double sum = std::accumulate(factors_.begin(), factors_.end(), 0.0);
        const auto scale = static_cast<float>(static_cast<double>(factors_.size()) / sum);
        for (float& factor : factors_) factor *= scale;
    }

 private:
    std::vector<float> factors_;
};

}  // namespace nlos
