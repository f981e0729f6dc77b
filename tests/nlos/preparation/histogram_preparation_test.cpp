// SPDX-License-Identifier: MIT
#include "nlos/preparation/histogram_preparation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace nlos {
namespace {

/// Two pairs: 20 empty bins, then ambient light of 2 and 5 counts, a signal in bins [40, 80).
core::Transient example_histograms() {
    core::Transient transient(2, 340);
    for (std::size_t pair = 0; pair < 2; ++pair) {
        for (std::size_t bin = 20; bin < 340; ++bin) {
            const float ambient = pair == 0 ? 2.0F : 5.0F;
            transient.histogram(pair)[bin] = ambient + (bin >= 40 && bin < 80 ? 100.0F : 0.0F);
        }
    }
    return transient;
}

TEST(HistogramPreparation, FindsAmbientLightAndTheSignalsEnd) {
    const auto signal = find_signal(example_histograms());
    ASSERT_TRUE(signal);
    EXPECT_DOUBLE_EQ(signal->ambient_per_bin[0], 2.0);
    EXPECT_DOUBLE_EQ(signal->ambient_per_bin[1], 5.0);
    EXPECT_EQ(signal->end_bin, 80);
}

TEST(HistogramPreparation, KeepsTheWholeAxisWithoutASignal) {
    core::Transient transient(1, 320);
    for (float& value : transient.values()) value = 3.0F;
    const auto signal = find_signal(transient);
    ASSERT_TRUE(signal);
    EXPECT_EQ(signal->end_bin, 320);
    EXPECT_FALSE(find_signal(core::Transient(1, 320)));
}

// Bins that a file was filled up with hold less than the background.
TEST(HistogramPreparation, ZeroesBehindABackgroundAreNotDark) {
    const core::Transient recorded = example_histograms();
    core::Transient longer(2, 500);
    for (std::size_t pair = 0; pair < 2; ++pair) {
        std::ranges::transform(recorded.histogram(pair),
                               longer.histogram(pair).begin(),
                               [](float value) { return 2.0F * value; });
    }
    const auto signal = find_signal(longer);
    ASSERT_TRUE(signal);
    EXPECT_DOUBLE_EQ(signal->ambient_per_bin[0], 4.0);
    EXPECT_DOUBLE_EQ(signal->ambient_per_bin[1], 10.0);
    EXPECT_EQ(signal->end_bin, 80);
}

// Means of several frames have less noise than counts, and no unit that tells.
TEST(HistogramPreparation, FindsTheBackgroundOfMeans) {
    std::mt19937 generator(3);
    core::Transient transient(100, 320);
    for (std::size_t pair = 0; pair < 100; ++pair) {
        for (std::size_t bin = 0; bin < 320; ++bin) {
            std::poisson_distribution<int> counts(bin >= 40 && bin < 80 ? 80.0 : 30.0);
            transient.histogram(pair)[bin] = 1e-3F * static_cast<float>(counts(generator)) / 4.0F;
        }
    }
    const auto signal = find_signal(transient, std::nullopt, core::TransientUnit::Radiance);
    ASSERT_TRUE(signal);
    EXPECT_TRUE(signal->has_background);
    EXPECT_NEAR(signal->ambient_per_bin[7], 0.0075, 0.0005);
    EXPECT_EQ(signal->end_bin, 80);
}

// A tail of light that falls is none.
TEST(HistogramPreparation, LightThatFallsIsNoBackground) {
    core::Transient transient(10, 320);
    for (std::size_t pair = 0; pair < 10; ++pair) {
        for (std::size_t bin = 0; bin < 320; ++bin) {
            transient.histogram(pair)[bin] = std::exp(-0.01F * static_cast<float>(bin));
        }
    }
    const auto signal = find_signal(transient, std::nullopt, core::TransientUnit::Radiance);
    ASSERT_TRUE(signal);
    EXPECT_FALSE(signal->has_background);
}

TEST(HistogramPreparation, TakesOffAmbientLightAndAddsUpBins) {
    const PreparationPlan plan{4, 20, {2.0, 5.0}};
    const core::Transient prepared = prepare_histograms(example_histograms(), plan);
    ASSERT_EQ(prepared.num_bins(), 20U);
    for (std::size_t pair = 0; pair < 2; ++pair) {
        for (std::size_t bin = 0; bin < 20; ++bin) {
            EXPECT_FLOAT_EQ(prepared.histogram(pair)[bin], bin >= 10 ? 400.0F : 0.0F);
        }
    }
}

TEST(HistogramPreparation, MultiplyingByRangeUndoesTheFalloff) {
    core::WallScan scan;
    scan.pattern = core::ScanPattern::Confocal;
    scan.sensing.positions = {core::Vec3(0.0, 0.0, 0.0), core::Vec3(0.3, 0.0, 0.0)};
    scan.sensing.normals.assign(2, core::Vec3::UnitZ());
    scan.illumination = scan.sensing;
    scan.opl_origin = core::OplOrigin::Device;
    scan.laser_position = scan.detector_position = core::Vec3(0.0, 0.0, -0.4);
    const core::TimeAxis axis{0.5, 0.1, 30};
    core::Transient transient(2, axis.num_bins);
    for (float& value : transient.values()) value = 2.0F;
    multiply_by_range(scan, axis, 4.0, transient);
    for (const int bin : {0, 1, 5, 29}) {
        const double range = 0.5 * (0.55 + 0.1 * bin - 1.0);  // segments of 2 x 0.5 m
        const double expected = range > 0.0 ? 2.0 * std::pow(range, 4.0) : 0.0;
        EXPECT_NEAR(transient.histogram(1)[static_cast<std::size_t>(bin)], expected, 1e-6) << bin;
    }
}

}  // namespace
}  // namespace nlos
