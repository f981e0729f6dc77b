// SPDX-License-Identifier: MIT
#include "nlos/preparation/second_capture.h"

#include "renderer/core/system/parallel.h"
#include "tests/support/example_capture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

/// Many bins of one value.
core::Capture even_capture(core::TransientUnit unit, float value) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    capture.unit = unit;
    capture.time_axis.num_bins = 20000;
    capture.transient = core::Transient(capture.scan.num_pairs(), 20000);
    std::ranges::fill(capture.transient.values(), value);
    return capture;
}

/// Expects differences of no mean and this variance, within 5 of their own deviations.
void expect_noise(const core::Capture& capture,
                  double variance,
                  std::optional<double> photon = std::nullopt) {
    const core::Capture again = *measure_again(capture, photon);
    const auto before = capture.transient.values();
    const auto after = again.transient.values();
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        const double difference = double{after[i]} - double{before[i]};
        sum += difference;
        squares += difference * difference;
    }
    const auto count = static_cast<double>(before.size());
    EXPECT_NEAR(sum / count, 0.0, 5.0 * std::sqrt(variance / count));
    EXPECT_NEAR(squares / count, variance, 0.05 * variance);
}

TEST(SecondCapture, AddsTheNoiseOfCountsOnceMore) {
    for (const float count : {1.0F, 7.0F, 400.0F, 0.3F, 2.5F}) {
        const core::Capture capture = even_capture(core::TransientUnit::Counts, count);
        expect_noise(capture, count);
        const core::Capture again = *measure_again(capture);
        const auto values = again.transient.values();
        EXPECT_GE(*std::ranges::min_element(values), 0.0F);
    }
}

TEST(SecondCapture, AddsTheNoiseOfRadianceOnceMore) {
    core::Capture capture = even_capture(core::TransientUnit::Radiance, 3.0F);
    capture.variance = capture.transient;
    expect_noise(capture, 3.0);
}

TEST(SecondCapture, AddsTheNoiseOfPhotonsOnceMore) {
    const core::Capture capture = even_capture(core::TransientUnit::Radiance, 3.0F);
    expect_noise(capture, 0.75, 0.25);
}

TEST(SecondCapture, OfUnknownNoiseIsNone) {
    core::Capture capture = even_capture(core::TransientUnit::Radiance, 3.0F);
    EXPECT_FALSE(measure_again(capture).has_value());
    capture.variance = core::Transient(capture.transient.num_pairs(), 20000);
    EXPECT_FALSE(measure_again(capture).has_value());
}

TEST(SecondCapture, HasTheSameBitsForAnyNumberOfThreads) {
    const core::Capture capture = even_capture(core::TransientUnit::Counts, 5.0F);
    const auto run = [&](int threads) {
        const core::ThreadLimit limit(threads);
        const auto again = measure_again(capture);
        const auto values = again->transient.values();
        return std::vector<float>(values.begin(), values.end());
    };
    EXPECT_EQ(run(1), run(7));
}

}  // namespace
}  // namespace nlos
