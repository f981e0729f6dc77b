// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface_probability.h"

#include "renderer/core/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

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

/// Columns of a 12 x 12 grid of which the middle 6 x 6 have this brightness and those around less.
std::vector<double> plateau(double brightness, double around) {
    std::vector<double> peaks(144, 0.0);
    for (int i = 0; i < 144; ++i) {
        const int distance = std::max(std::abs(2 * (i / 12) - 11), std::abs(2 * (i % 12) - 11));
        peaks[static_cast<std::size_t>(i)] = distance < 6   ? brightness
                                             : distance < 8 ? around
                                                            : 0.0;
    }
    return peaks;
}

TEST(PlateauProbabilities, KeepPlateausAndLeaveOutTheirSmearedEdges) {
    const std::vector<double> weights(144, 1.0);
    const std::vector<double> blurred = plateau_probabilities(plateau(2.0, 1.0), weights, 12, {});
    EXPECT_GT(blurred[5 * 12 + 5], 0.9);
    EXPECT_LT(blurred[2 * 12 + 5], 0.2);
    EXPECT_EQ(blurred[0], 0.0);
}

// Beside a plateau of the same size that is four times as bright.
TEST(PlateauProbabilities, KeepDimSurfacesBesideBrightOnes) {
    std::vector<double> peaks = plateau(8.0, 0.0);
    const std::vector<double> dim = plateau(2.0, 0.0);
    peaks.insert(peaks.end(), dim.begin(), dim.end());
    const std::vector<double> weights(288, 1.0);
    const std::vector<double> both = plateau_probabilities(peaks, weights, 12, {});
    EXPECT_GT(both[144 + 5 * 12 + 5], 0.5);
    const std::vector<double> strict = plateau_probabilities(peaks, weights, 12, {0.7, 0.45});
    EXPECT_LT(strict[144 + 5 * 12 + 5], 0.2);
}

TEST(PlateauProbabilities, CrossOneHalfAtTheFractionOfAllSurfaces) {
    std::vector<double> peaks(100, 2.0);
    peaks.insert(peaks.end(), {0.0, 0.0, 0.4, 0.0, 0.0});
    std::vector<double> weights(peaks.size(), 1.0);
    weights[102] = 0.0;  // so that both means are those of the others
    const std::vector<double> probabilities = plateau_probabilities(peaks, weights, 1, {});
    EXPECT_NEAR(probabilities[102], 0.5, 1e-3);
    EXPECT_EQ(probabilities[103], 0.0);
}

TEST(PlateauProbabilities, OfDarknessAreZero) {
    EXPECT_EQ(plateau_probabilities({0.0, 0.0}, {1.0, 1.0}, 2, {}),
              (std::vector<double>{0.0, 0.0}));
}

}  // namespace
}  // namespace nlos
