// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal/pixel_position_sampler.h"

#include "renderer/core/random.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

namespace {

using core::Vec2;
using core::Vec3;
using renderer::PixelPositionSampler;

struct BandCase {
    Vec2 slope_m;
    renderer::OplBand wanted;
    Vec2 other_slope_m = Vec2::Zero();  ///< of a second strip; 0: none
};

PixelPositionSampler::Band band_of(const BandCase& c) {
    PixelPositionSampler::Band band;
    band.add_strip(1.0, c.slope_m, c.wanted);
    band.add_strip(1.0, c.other_slope_m, c.wanted);
    return band;
}

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
                           {{0.0, 0.0}, {0.9, 1.2}},
                           {{0.01, 0.004}, {1.002, 1.003}, {-0.01, 0.02}},
                           {{0.01, 0.004}, {1.002, 1.003}, {0.0101, 0.004}}};  // much the same

TEST(PixelPositionSampler, SamplesFollowTheDensity) {
    constexpr int kCells = 16;
    constexpr int kSamples = 200'000;
    constexpr int kPointsPerCell = 64;  // per side, of the midpoint rule
    core::Rng rng(test_support::seed_of("PixelPositionSampler"), 0, 0);
    for (const BandCase& c : kBands) {
        const PixelPositionSampler::Band band = band_of(c);
        std::vector<double> expected(kCells * kCells);
        const int points = kCells * kPointsPerCell;
        for (int i = 0; i < points; ++i) {
            for (int j = 0; j < points; ++j) {
                const Vec2 position((i + 0.5) / points, (j + 0.5) / points);
                expected[static_cast<std::size_t>(i / kPointsPerCell * kCells +
                                                  j / kPointsPerCell)] +=
                    band.pdf(position) * kSamples / (1.0 * points * points);
            }
        }
        std::vector<double> observed(kCells * kCells);
        for (int i = 0; i < kSamples; ++i) {
            const double u1 = (i + rng.uniform()) / kSamples;
            const Vec2 position = band.sample({u1, rng.uniform()});
            ASSERT_GE(position.minCoeff(), 0.0);
            ASSERT_LE(position.maxCoeff(), 1.0);
            const Vec2 cell = (position * kCells).cwiseMin(kCells - 1);
            ++observed[static_cast<std::size_t>(static_cast<int>(cell.x()) * kCells +
                                                static_cast<int>(cell.y()))];
        }
        EXPECT_GT(test_support::chi_square_p_value(observed, expected),
                  test_support::sidak_level(1e-3, std::size(kBands)))
            << c.slope_m.transpose() << ", " << c.wanted.low_m;
    }
}

TEST(PixelPositionSampler, HalfOfThePositionsHaveWantedLengths) {
    const PixelPositionSampler::Band band = band_of({{0.01, 0.004}, {1.002, 1.003}});
    core::Rng rng(test_support::seed_of("HalfOfThePlaces"), 0, 0);
    int wanted = 0;
    for (int i = 0; i < 1000; ++i) {
        const Vec2 position = band.sample({(i + 0.5) / 1000, rng.uniform()});
        const double opl_m = 1.0 + 0.01 * position.x() + 0.004 * position.y();
        if (opl_m >= 1.002 && opl_m <= 1.003) ++wanted;
    }
    EXPECT_GT(wanted, 500);  // and a few of the others
    EXPECT_LT(wanted, 600);
}

// A floor seen at a grazing angle, where lengths are far from linear within a pixel, and the wall
// behind it, so that pixels of their common edge see both.
TEST(PixelPositionSampler, FindsShortGatesOnGrazingFloorsAndInCorners) {
    const std::vector<renderer::Object> room{
        test_support::parallelogram_object({{-2, 0, -1}, {4, 0, 0}, {0, 0, 3}, 0.5}),
        test_support::parallelogram_object({{-2, 0, 2}, {4, 0, 0}, {0, 2, 0}, 0.5})};
    core::PinholeCamera camera;
    camera.position_m = Vec3(0, 0.25, -1);
    camera.look_at_m = Vec3(0, 0.1, 2);
    camera.fov_y_deg = 20.0;
    camera.resolution = {16, 12};
    camera.light_m = Vec3(0.7, 0.8, -0.2);
    const core::Scan scan = test_support::image_of(camera);
    const renderer::Scene scene({room, {}}, scan, {});
    const renderer::SensorPairs measurement(scene, scan);
    const PixelPositionSampler sampler(measurement, camera);
    constexpr int kPositions = 20'000;
    for (const double gate_m : {3.2, 5.37}) {
        int pixels_that_reach = 0;
        const renderer::OplBand wanted{gate_m, gate_m + 4e-3};
        for (std::size_t pixel = 0; pixel < camera.num_pixels(); ++pixel) {
            const PixelPositionSampler::Band band = sampler.band(pixel, wanted);
            core::Rng rng(test_support::seed_of("FindsShortGates"), pixel, 0);
            const auto is_wanted = [&](const Vec2& position) {
                const auto seen = measurement.first_vertex(pixel, position);
                const double opl_m = seen ? seen->optical_path.opl_m +
                                                (*camera.light_m - seen->point.position).norm()
                                          : 0.0;
                return opl_m >= wanted.low_m && opl_m < wanted.high_m;
            };
            int reached = 0;  // by places drawn uniformly
            int foreseen = 0;
            double fraction = 0.0;  // by places drawn from the band
            double squares = 0.0;
            for (int i = 0; i < kPositions; ++i) {
                const Vec2 anywhere(rng.uniform(), rng.uniform());
                if (is_wanted(anywhere)) {
                    ++reached;
                    if (band.pdf(anywhere) > 0.5) ++foreseen;
                }
                const Vec2 drawn = band.sample({rng.uniform(), rng.uniform()});
                if (is_wanted(drawn)) {
                    fraction += 1.0 / (kPositions * band.pdf(drawn));
                    squares += std::pow(band.pdf(drawn) * kPositions, -2);
                }
            }
            if (reached < 50) continue;
            ++pixels_that_reach;
            EXPECT_GE(foreseen, 0.95 * reached) << pixel << ", " << gate_m;
            // Five standard deviations of either estimate.
            const double sigma =
                std::sqrt(reached + squares * kPositions * kPositions) / kPositions;
            EXPECT_NEAR(fraction, reached / double{kPositions}, 5.0 * sigma)
                << pixel << ", " << gate_m;
        }
        EXPECT_GT(pixels_that_reach, 5) << gate_m;
    }
}

}  // namespace
