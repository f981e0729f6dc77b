// SPDX-License-Identifier: MIT
#include "renderer/pixel_places.h"

#include "renderer/core/random.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

namespace {

using core::Vec2;
using renderer::PixelPlaces;

struct BandCase {
    Vec2 slope_m;
    renderer::OplBand wanted;
};

// Lengths at the pixel's upper left corner: 1 m.
const BandCase kBands[] = {{{0.01, 0.004}, {1.002, 1.003}},   // rising part of the lengths' density
                           {{0.01, 0.004}, {1.006, 1.0065}},  // flat part
                           {{0.01, 0.004}, {1.012, 1.02}},    // to beyond its end
                           {{-0.003, 0.02}, {1.0, 1.01}},
                           {{0.01, -0.01}, {0.999, 1.001}},
                           {{0.0, 0.01}, {1.001, 1.002}},
                           {{-0.01, 0.0}, {0.994, 0.9945}},
                           {{0.01, 0.01}, {1.05, 1.06}},  // never reached
                           {{0.01, 0.01}, {0.9, 1.2}},    // always
                           {{0.0, 0.0}, {0.9, 1.2}}};

TEST(PixelPlaces, SamplesFollowTheDensity) {
    constexpr int kCells = 16;
    constexpr int kSamples = 200'000;
    constexpr int kPointsPerCell = 64;  // per side, of the midpoint rule
    core::Rng rng(test_support::seed_of("PixelPlaces"), 0, 0);
    for (const BandCase& c : kBands) {
        const PixelPlaces::Band band(1.0, c.slope_m, c.wanted);
        std::vector<double> expected(kCells * kCells);
        const int points = kCells * kPointsPerCell;
        for (int i = 0; i < points; ++i) {
            for (int j = 0; j < points; ++j) {
                const Vec2 place((i + 0.5) / points, (j + 0.5) / points);
                expected[static_cast<std::size_t>(i / kPointsPerCell * kCells +
                                                  j / kPointsPerCell)] +=
                    band.pdf(place) * kSamples / (1.0 * points * points);
            }
        }
        std::vector<double> observed(kCells * kCells);
        for (int i = 0; i < kSamples; ++i) {
            const double u1 = (i + rng.uniform()) / kSamples;
            const Vec2 place = band.sample({u1, rng.uniform()});
            ASSERT_GE(place.minCoeff(), 0.0);
            ASSERT_LE(place.maxCoeff(), 1.0);
            const Vec2 cell = (place * kCells).cwiseMin(kCells - 1);
            ++observed[static_cast<std::size_t>(static_cast<int>(cell.x()) * kCells +
                                                static_cast<int>(cell.y()))];
        }
        EXPECT_GT(test_support::chi_square_p_value(observed, expected),
                  test_support::sidak_level(1e-3, std::size(kBands)))
            << c.slope_m.transpose() << ", " << c.wanted.low_m;
    }
}

TEST(PixelPlaces, HalfOfThePlacesHaveWantedLengths) {
    const PixelPlaces::Band band(1.0, {0.01, 0.004}, {1.002, 1.003});
    core::Rng rng(test_support::seed_of("HalfOfThePlaces"), 0, 0);
    int wanted = 0;
    for (int i = 0; i < 1000; ++i) {
        const Vec2 place = band.sample({(i + 0.5) / 1000, rng.uniform()});
        const double opl_m = 1.0 + 0.01 * place.x() + 0.004 * place.y();
        if (opl_m >= 1.002 && opl_m <= 1.003) ++wanted;
    }
    EXPECT_GT(wanted, 500);  // and a few of the others
    EXPECT_LT(wanted, 600);
}

}  // namespace
