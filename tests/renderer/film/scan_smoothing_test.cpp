// SPDX-License-Identifier: MIT
#include "renderer/film/scan_smoothing.h"

#include "renderer/core/random.h"
#include "tests/support/example_capture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace {

core::WallScan confocal_grid(std::size_t x, std::size_t y) {
    core::WallScan scan;
    scan.illumination = test_support::example_grid(x, y);
    scan.sensing = scan.illumination;
    return scan;
}

double sum_of(const core::Transient& t) {
    return std::accumulate(t.values().begin(), t.values().end(), 0.0);
}

double squared_distance(const core::Transient& a, const core::Transient& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        sum += std::pow(double{a.values()[i]} - double{b.values()[i]}, 2);
    }
    return sum;
}

// A ridge across the grid that moves through the bins.
core::Transient ridge(std::size_t side, int bins, double width) {
    core::Transient result(side * side, bins);
    for (std::size_t pair = 0; pair < side * side; ++pair) {
        for (int bin = 0; bin < bins; ++bin) {
            const double off = 0.5 * static_cast<double>(pair / side) + bin - 0.7 * bins * 0.5;
            result.histogram(pair)[static_cast<std::size_t>(bin)] =
                static_cast<float>(std::exp(-0.5 * off * off / (width * width)));
        }
    }
    return result;
}

core::Transient with_noise(core::Transient truth, double deviation, std::uint64_t seed) {
    for (std::size_t i = 0; i < truth.values().size(); ++i) {
        core::Rng rng(seed, i, 0);
        // Uniform, of unit variance.
        truth.values()[i] +=
            static_cast<float>(deviation * std::sqrt(12.0) * (rng.uniform() - 0.5));
    }
    return truth;
}

TEST(ScanSmoothing, SpreadsAnImpulseAsTriangles) {
    const core::WallScan scan = confocal_grid(9, 7);
    core::Transient impulse(63, 16);
    impulse.histogram(4 * 7 + 3)[8] = 1.0F;
    const core::Transient smooth = renderer::smooth_scan(impulse, scan, {3, 2});
    for (int x = 0; x < 9; ++x) {
        for (int y = 0; y < 7; ++y) {
            for (int bin = 0; bin < 16; ++bin) {
                const double expected = std::max(0, 3 - std::abs(x - 4)) / 9.0 *
                                        std::max(0, 3 - std::abs(y - 3)) / 9.0 *
                                        std::max(0, 2 - std::abs(bin - 8)) / 4.0;
                EXPECT_NEAR(smooth.histogram(
                                static_cast<std::size_t>(7 * x + y))[static_cast<std::size_t>(bin)],
                            expected,
                            1e-7);  // a few ulp of single precision
            }
        }
    }
}

TEST(ScanSmoothing, KeepsTheSumAtEveryBorder) {
    core::WallScan exhaustive;
    exhaustive.pattern = core::ScanPattern::Exhaustive;
    exhaustive.illumination = test_support::example_grid(3, 4);
    exhaustive.sensing = test_support::example_grid(5, 2);
    for (const std::size_t pair : {std::size_t{0}, std::size_t{57}, std::size_t{119}}) {
        for (const std::size_t bin : {std::size_t{0}, std::size_t{5}}) {
            core::Transient impulse(120, 6);
            impulse.histogram(pair)[bin] = 1.0F;
            const core::Transient smooth = renderer::smooth_scan(impulse, exhaustive, {4, 3});
            EXPECT_NEAR(sum_of(smooth), 1.0, 1e-5);
        }
    }
}

TEST(ScanSmoothing, PointsOfAListHaveNoNeighbours) {
    core::WallScan scan = confocal_grid(4, 4);
    scan.sensing = test_support::as_list(scan.sensing);
    const core::Transient values = with_noise(core::Transient(16, 32), 1.0, 1);
    EXPECT_EQ(squared_distance(renderer::smooth_scan(values, scan, {4, 1}), values), 0.0);
    EXPECT_GT(squared_distance(renderer::smooth_scan(values, scan, {1, 2}), values), 0.0);
}

// Over 20 draws of noise: widths are chosen that lower the error, and the error that is reported is
// the true one, or above it where one deviation of the bias is most of what is left.
TEST(ScanSmoothing, ChoosesWidthsByTheTrueError) {
    constexpr std::size_t kSide = 16;
    constexpr int kBins = 64;
    const core::WallScan scan = confocal_grid(kSide, kSide);
    struct Case {
        double width;
        double noise;
        double gain;  ///< of the squared error, at least
    };
    for (const auto& [width, noise, gain] :
         {Case{0.3, 0.02, 1.0}, Case{2.0, 0.2, 10.0}, Case{8.0, 0.2, 50.0}}) {
        const core::Transient truth = ridge(kSide, kBins, width);
        double reported = 0.0;
        double found = 0.0;
        double signal = 0.0;
        constexpr int kDraws = 20;
        for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
            const auto smoothed = renderer::smooth_mean(with_noise(truth, noise, 2 * draw),
                                                        with_noise(truth, noise, 2 * draw + 1),
                                                        scan,
                                                        nullptr);
            EXPECT_EQ(smoothed.widths.points > 1, width > 1.0);
            EXPECT_EQ(smoothed.widths.bins > 1, width > 1.0);
            reported += smoothed.squared_error / kDraws;
            found += squared_distance(smoothed.mean, truth) / kDraws;
            signal += smoothed.squared_signal / kDraws;
        }
        const double unsmoothed = 0.5 * noise * noise * static_cast<double>(truth.values().size());
        EXPECT_LE(gain * found, 1.02 * unsmoothed) << width;
        EXPECT_LE(found, 1.02 * reported) << width;
        EXPECT_GE(found, 0.5 * reported) << width;
        const core::Transient dark(kSide * kSide, kBins);
        EXPECT_NEAR(signal, squared_distance(truth, dark), 0.05 * signal) << width;
    }
}

TEST(ScanSmoothing, SignalCountsWhatIsKnownBefore) {
    const core::WallScan scan = confocal_grid(4, 4);
    core::Transient known(16, 8);
    for (float& value : known.values()) value = 3.0F;
    core::Transient sampled(16, 8);
    for (float& value : sampled.values()) value = 1.0F;
    const auto smoothed = renderer::smooth_mean(sampled, sampled, scan, &known);
    EXPECT_NEAR(smoothed.squared_signal, 16.0 * 16.0 * 8.0, 1e-6);
    EXPECT_EQ(smoothed.squared_error, 0.0);
    EXPECT_EQ(smoothed.widths.points, 1);
}

}  // namespace
