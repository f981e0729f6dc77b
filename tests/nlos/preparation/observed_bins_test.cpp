// SPDX-License-Identifier: MIT
// Bins that were not observed count neither as light nor as darkness.
#include "nlos/detector/detector.h"
#include "nlos/preparation/checks/capture_check.h"
#include "nlos/preparation/first_light.h"
#include "nlos/preparation/gated_capture.h"
#include "nlos/preparation/histogram_preparation.h"
#include "nlos/preparation/prepared_capture.h"
#include "nlos/preparation/wiener_snr.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nlos {
namespace {

using core::BinRange;
using core::Vec3;

/// Ambient light of 1 + pair, 100 more in bins [150, 170) of 320.
core::Capture lit_pairs(std::size_t num_pairs) {
    core::Capture capture;
    capture.scan.wall().pattern = core::ScanPattern::Confocal;
    capture.scan.wall().sensing = nlos_test::wall_grid({num_pairs, 1}, {0.1, 0.1});
    capture.scan.wall().illumination = capture.scan.wall().sensing;
    capture.time_axis = {0.0, 0.01, 320};
    capture.transient = core::Transient(num_pairs, 320);
    for (std::size_t pair = 0; pair < num_pairs; ++pair) {
        for (std::size_t bin = 0; bin < 320; ++bin) {
            capture.transient.histogram(pair)[bin] =
                static_cast<float>(1 + pair) + (bin >= 150 && bin < 170 ? 100.0F : 0.0F);
        }
    }
    capture.unit = core::TransientUnit::Counts;
    return capture;
}

TEST(ObservedStatistics, AmbientLightComesFromObservedBins) {
    core::Capture capture = lit_pairs(4);
    core::restrict_observed(capture, {{0, 320}, {20, 300}, {0, 0}, {140, 180}});
    const auto signal = find_signal(capture.transient, capture.observed);
    ASSERT_TRUE(signal);
    EXPECT_DOUBLE_EQ(signal->ambient_per_bin[0], 1.0);
    EXPECT_DOUBLE_EQ(signal->ambient_per_bin[1], 2.0);
    // A dead pair and one that saw the signal alone take what the others saw.
    EXPECT_GE(signal->ambient_per_bin[2], 1.0);
    EXPECT_LE(signal->ambient_per_bin[2], 2.0);
    EXPECT_DOUBLE_EQ(signal->ambient_per_bin[2], signal->ambient_per_bin[3]);
    EXPECT_EQ(signal->end_bin, 170);
    // Taken for darkness, the same bins would give less.
    EXPECT_EQ(find_signal(capture.transient)->ambient_per_bin[3], 0.0);
}

TEST(ObservedStatistics, PreparedBinsAreThoseObservedAsAWhole) {
    core::Capture capture = lit_pairs(3);
    core::restrict_observed(capture, {{0, 320}, {142, 167}, {0, 0}});
    PreparationPlan plan{4, 60, {1.0, 2.0, 3.0}};
    plan.observed = capture.observed;
    const core::Transient prepared = prepare_histograms(capture.transient, plan);
    const core::ObservedBins observed = prepared_observed(plan);
    ASSERT_TRUE(observed);
    EXPECT_EQ((*observed)[0], (BinRange{0, 60}));
    EXPECT_EQ((*observed)[1], (BinRange{36, 41}));
    EXPECT_EQ((*observed)[2].size(), 0);
    for (std::size_t bin = 0; bin < 60; ++bin) {
        const bool is_lit = bin >= 38 && bin < 41;
        EXPECT_EQ(prepared.histogram(1)[bin], is_lit ? 400.0F : bin == 37 ? 200.0F : 0.0F) << bin;
        EXPECT_EQ(prepared.histogram(2)[bin], 0.0F);
    }
}

TEST(ObservedStatistics, SignalToNoiseRatioIsThatOfAnAxisOfObservedBins) {
    core::Capture capture = lit_pairs(3);
    core::restrict_observed(capture, {120, 200});
    core::Capture shorter = capture;
    shorter.time_axis = {1.2, 0.01, 80};
    shorter.transient = core::Transient(3, 80);
    shorter.observed.reset();
    for (std::size_t pair = 0; pair < 3; ++pair) {
        std::ranges::copy(capture.observed_values(pair), shorter.transient.histogram(pair).begin());
    }
    const auto ratio = [](const core::Capture& of, int num_bins) {
        PreparationPlan plan{1, num_bins, {1.0, 2.0, 3.0}};
        plan.observed = of.observed;
        return wiener_snr(of.scan.wall(), of.time_axis, of.transient, plan, Falloff::Diffuse);
    };
    const double observed = ratio(capture, 320);
    EXPECT_NEAR(observed, ratio(shorter, 80), 1e-9);
    capture.observed.reset();
    EXPECT_GT(ratio(capture, 320), observed + 0.001) << "darkness below ambient light is no signal";
}

TEST(ObservedStatistics, TheAxisEndsWhereNobodyLooked) {
    core::Capture capture = lit_pairs(3);
    core::restrict_observed(capture, {{140, 200}, {0, 0}, {150, 210}});
    const PreparedCapture prepared = crop_capture(capture, {});
    EXPECT_EQ(prepared.time_axis.num_bins, 70);
    EXPECT_DOUBLE_EQ(prepared.time_axis.opl_start_m, 1.4);
    ASSERT_TRUE(prepared.observed);
    EXPECT_EQ((*prepared.observed)[0], (BinRange{0, 60}));
    EXPECT_EQ((*prepared.observed)[1].size(), 0);
    EXPECT_EQ((*prepared.observed)[2], (BinRange{10, 70}));
    EXPECT_EQ(prepared.transient().histogram(2)[10], 103.0F);

    core::restrict_observed(capture, {{150, 200}, {0, 0}, {150, 200}});
    CropSettings crop;
    crop.opl_range_m = {1.6, 3.0};
    crop.x_range_m = {0.05, 0.15};
    const PreparedCapture part = crop_capture(capture, crop);
    EXPECT_EQ(part.time_axis.num_bins, 40);
    EXPECT_FALSE(part.observed) << "the one pair that is left observed all bins that are left";
    crop.x_range_m = {-0.05, 0.05};
    EXPECT_ERROR_WITH(crop_capture(capture, crop), "found no observed bin");
}

TEST(ObservedStatistics, MidpointsAverageThePairsThatLooked) {
    core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({4, 4}, {0.1, 0.1}), {0.0, 0.02, 100});
    capture.scan.wall().pattern = core::ScanPattern::Exhaustive;
    capture.transient = core::Transient(256, 100);
    for (float& value : capture.transient.values()) value = 1.0F;
    const core::Capture whole_capture = capture;
    PreparedCapture whole = crop_capture(whole_capture, {});
    std::vector<BinRange> ranges(256, {0, 100});
    for (std::size_t pair = 0; pair < 256; pair += 3) ranges[pair] = {0, 0};
    for (std::size_t pair = 1; pair < 256; pair += 3) ranges[pair] = {40, 90};
    core::restrict_observed(capture, ranges);
    PreparedCapture part = crop_capture(capture, {});
    ASSERT_TRUE(convert_to_confocal(whole) && convert_to_confocal(part) && part.observed);
    ASSERT_EQ(part.time_axis.opl_start_m, whole.time_axis.opl_start_m);
    std::size_t compared = 0;
    for (std::size_t point = 0; point < part.scan.sensing.size(); ++point) {
        const BinRange range = (*part.observed)[point];
        for (int bin = 0; bin < part.time_axis.num_bins; ++bin) {
            const float value = part.transient().histogram(point)[static_cast<std::size_t>(bin)];
            if (!range.holds(bin)) {
                EXPECT_EQ(value, 0.0F);
            } else if (bin >= 45 && bin < 85) {
                const float wanted =
                    whole.transient().histogram(point)[static_cast<std::size_t>(bin)];
                EXPECT_NEAR(value, wanted, 0.05F * wanted);
                ++compared;
            }
        }
    }
    EXPECT_GT(compared, 1000U);
}

TEST(ObservedStatistics, AGateIsSeenWhereAllOfItWas) {
    core::Capture capture = lit_pairs(3);
    core::restrict_observed(capture, {{140, 200}, {155, 200}, {0, 0}});
    const core::Capture gated = gated_capture(capture, 1.5, 0.2);
    ASSERT_TRUE(gated.observed);
    EXPECT_EQ(gated.observed_range(0).size(), 1);
    EXPECT_EQ(gated.transient.histogram(0)[0], 20.0F * 101.0F);
    EXPECT_EQ(gated.observed_range(1).size(), 0);
    EXPECT_EQ(gated.transient.histogram(1)[0], 0.0F);
    EXPECT_EQ(gated.observed_range(2).size(), 0);
}

TEST(ObservedStatistics, FirstLightIsNotWhereAGateOpens) {
    core::Capture capture = lit_pairs(3);
    const auto before = first_light_m(capture, 0, 1.0);
    core::restrict_observed(capture, {{100, 320}, {155, 320}, {0, 0}});
    ASSERT_TRUE(before);
    EXPECT_DOUBLE_EQ(*first_light_m(capture, 0, 1.0), *before);
    EXPECT_FALSE(first_light_m(capture, 1, 2.0));
    EXPECT_FALSE(first_light_m(capture, 2, 3.0));
}

TEST(ObservedStatistics, ChecksOfAGoodCaptureSayNothingOfGatesAndDeadPoints) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({32, 32}, {0.03, 0.03}), {0.0, 0.008, 500});
    for (int i = 0; i <= 20; ++i) {
        const double t = 0.1 * i - 1.0;
        nlos_test::add_scatterer(capture, Vec3(0.2 * t, 0.05 + 0.1 * t, 0.6 + 0.1 * t * t), 4.0);
    }
    DetectorSettings settings;
    settings.photons = 2e6;
    settings.ambient = 0.5;
    capture = detect(capture, settings);
    ASSERT_TRUE(capture_warnings(capture).empty());
    std::vector<BinRange> ranges(1024, {100, 400});
    for (std::size_t pair = 0; pair < 1024; pair += 3) ranges[pair] = {0, 0};
    core::restrict_observed(capture, ranges);
    EXPECT_TRUE(capture_warnings(capture).empty());
    // And what they warn of is seen all the same.
    core::Capture narrow = capture;
    narrow.time_axis.bin_width_m *= 1.3;
    narrow.time_axis.opl_start_m += 0.0;
    EXPECT_EQ(capture_warnings(narrow).size(), 1U);
    core::restrict_observed(capture, {0, 0});
    EXPECT_EQ(capture_warnings(capture),
              std::vector<std::string>{"no bin of any pair was observed"});
}

}  // namespace
}  // namespace nlos
