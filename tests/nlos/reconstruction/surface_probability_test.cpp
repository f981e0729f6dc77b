// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface_probability.h"

#include "renderer/core/random.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace nlos {
namespace {

TEST(FalseDiscoveryRates, AreOneWhereNothingButNoiseIs) {
    core::Rng rng(1, 0, 0);
    std::vector<double> p_values;
    for (int i = 0; i < 2000; ++i) p_values.push_back(rng.uniform());
    const std::vector<double> rates = false_discovery_rates(p_values);
    EXPECT_LT(std::ranges::count_if(rates, [](double rate) { return rate < 0.5; }), 20);
}

TEST(FalseDiscoveryRates, TellFewDiscoveriesFromMuchNoise) {
    core::Rng rng(2, 0, 0);
    std::vector<double> p_values(100, 1e-9);
    for (int i = 0; i < 1900; ++i) p_values.push_back(rng.uniform());
    const std::vector<double> rates = false_discovery_rates(p_values);
    EXPECT_LT(*std::max_element(rates.begin(), rates.begin() + 100), 1e-3);
    EXPECT_LT(std::count_if(rates.begin() + 100, rates.end(), [](double r) { return r < 0.5; }),
              20);
}

TEST(PlateauProbabilities, CrossOneHalfAtAShareOfTheSurfacesBrightness) {
    std::vector<double> peaks(100, 2.0);
    peaks.insert(peaks.end(), {0.9, 0.2, 0.0});
    std::vector<double> weights(peaks.size(), 1.0);
    weights[100] = weights[101] = 0.0;  // so that the mean is that of the plateau
    const std::vector<double> probabilities = plateau_probabilities(peaks, weights, 0.45);
    EXPECT_GT(probabilities[0], 0.95);
    EXPECT_NEAR(probabilities[100], 0.5, 1e-6);
    EXPECT_LT(probabilities[101], 3e-3);
    EXPECT_EQ(probabilities[102], 0.0);
}

TEST(PlateauProbabilities, OfDarknessAreZero) {
    EXPECT_EQ(plateau_probabilities({0.0, 0.0}, {1.0, 1.0}, 0.45), (std::vector<double>{0.0, 0.0}));
}

}  // namespace
}  // namespace nlos
