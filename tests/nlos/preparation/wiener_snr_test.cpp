// SPDX-License-Identifier: MIT
#include "nlos/preparation/wiener_snr.h"

#include "nlos/detector/detector.h"
#include "tests/support/example_capture.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nlos {
namespace {

/// A confocal scan of histograms with one peak each, in radiance.
core::Capture peaked_capture() {
    core::Capture capture;
    capture.scan.wall().sensing = test_support::example_grid(16, 16);
    capture.scan.wall().illumination = capture.scan.wall().sensing;
    capture.time_axis = {0.4, 0.008, 128};
    capture.transient = core::Transient(256, 128);
    for (std::size_t pair = 0; pair < 256; ++pair) {
        const auto histogram = capture.transient.histogram(pair);
        for (std::size_t bin = 0; bin < 128; ++bin) {
            const double x =
                (static_cast<double>(bin) - 40.0 - 0.1 * static_cast<double>(pair)) / 4.0;
            histogram[bin] = static_cast<float>(std::exp(-0.5 * x * x));
        }
    }
    return capture;
}

TEST(WienerSnr, CountsTellTheRatioOfTheirPowers) {
    const core::Capture clean = peaked_capture();
    const PreparationPlan plan{2, 64, std::vector<double>(256, 0.5)};
    for (const double photons_per_point : {30.0, 300.0, 3000.0}) {
        DetectorSettings settings;
        settings.photons_per_point = photons_per_point;
        settings.ambient = 0.5;
        settings.seed = test_support::seed_of("CountsTellTheRatioOfTheirPowers");
        const core::Capture counts = detect(clean, settings);
        settings.expected = true;
        const core::Capture expected = detect(clean, settings);
        double signal = 0.0;
        double noise = 0.0;
        for (std::size_t pair = 0; pair < 256; ++pair) {
            for (std::size_t bin = 0; bin < 64; ++bin) {
                const auto histogram = expected.transient.histogram(pair);
                const double mean = histogram[2 * bin] + histogram[2 * bin + 1];
                const double range = 0.5 * (0.4 + 0.016 * (static_cast<double>(bin) + 0.5));
                const double weight = std::pow(range, 8.0) / (2.0 * range);
                signal += weight * std::pow(mean - 1.0, 2);
                noise += weight * mean;
            }
        }
        const double wanted = 1.0 / (1.0 + noise / signal);
        const double found = wiener_snr(
            counts.scan.wall(), counts.time_axis, counts.transient, plan, Falloff::Diffuse);
        EXPECT_NEAR(found / wanted, 1.0, 0.1) << photons_per_point;
    }
}

TEST(WienerSnr, NothingButNoiseGivesTheSmallest) {
    core::Capture capture = peaked_capture();
    for (float& value : capture.transient.values()) value = 0.0F;
    const PreparationPlan plan{1, 128, {}};
    EXPECT_EQ(
        wiener_snr(
            capture.scan.wall(), capture.time_axis, capture.transient, plan, Falloff::Diffuse),
        1e-3);
}

}  // namespace
}  // namespace nlos
