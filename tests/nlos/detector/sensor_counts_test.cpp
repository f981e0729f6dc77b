// SPDX-License-Identifier: MIT
#include "nlos/detector/sensor_counts.h"

#include "tests/support/error_message.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <numeric>

namespace nlos {
namespace {

core::SensorSetup straight_sensor() {
    core::SensorSetup setup;
    setup.model = core::read_sensor_model("vl53l8");
    setup.model.zones = {3, 2};
    setup.pose.position_m = core::Vec3(0, 0, 1);
    setup.wall.size_m = {5.0, 5.0};
    return setup;
}

/// Light in zone 1 (the middle of the upper row), bin 40, and half of it in a frame before.
core::Capture one_bright_zone(const core::SensorSetup& setup) {
    core::Capture capture;
    capture.scan = core::scan_of_zones(setup);
    capture.time_axis = setup.model.time_axis();
    capture.transient = core::Transient(6, capture.time_axis.num_bins);
    capture.transient.histogram(1)[40] = 100.0F;
    core::Transient before = capture.transient;
    before.histogram(1)[40] = 50.0F;
    capture.sequence = core::FrameSequence{{before, capture.transient}, 0.0, 0.04};
    return capture;
}

double sum(const core::Transient& transient) {
    return std::accumulate(transient.values().begin(), transient.values().end(), 0.0);
}

TEST(SensorCounts, CrosstalkMovesLightToNeighboursAndLosesNone) {
    core::SensorSetup setup = straight_sensor();
    setup.model.detector.zone_crosstalk = 0.1;
    core::Capture capture = one_bright_zone(setup);
    add_crosstalk(setup, capture);
    const std::vector<float> expected{10.0F, 70.0F, 10.0F, 0.0F, 10.0F, 0.0F};
    for (std::size_t zone = 0; zone < 6; ++zone) {
        EXPECT_FLOAT_EQ(capture.transient.histogram(zone)[40], expected[zone]);
        EXPECT_FLOAT_EQ(capture.sequence->frames[0].histogram(zone)[40], 0.5F * expected[zone]);
    }
    EXPECT_FLOAT_EQ(static_cast<float>(sum(capture.transient)), 100.0F);
}

TEST(SensorCounts, GlassSendsBackAFractionOfAWhiteWallAtTimeZero) {
    core::SensorSetup setup = straight_sensor();
    setup.model.detector.zone_crosstalk = 0.0;
    setup.model.detector.cover_glass_crosstalk = 0.5;
    core::Capture capture = one_bright_zone(setup);
    add_crosstalk(setup, capture);
    // A square field of half-angle a lights 4 asin(sin^2 a) sr.
    const double half = 22.5 / core::kDegreesPerRadian;
    const double field_sr = 4.0 * std::asin(std::pow(std::sin(half), 2));
    for (std::size_t zone = 0; zone < 6; ++zone) {
        EXPECT_NEAR(capture.transient.histogram(zone)[0], 0.5 / core::kPi / field_sr, 1e-6);
    }
    capture.unit = core::TransientUnit::Counts;
    EXPECT_ERROR_WITH(add_crosstalk(setup, capture), "cover glass");
}

TEST(SensorCounts, FirmwareCutsUpToTheDirectReturnAndSomeBinsMore) {
    core::SensorSetup setup = straight_sensor();
    core::Capture capture = one_bright_zone(setup);
    cut_direct_return(setup, capture);
    EXPECT_FALSE(capture.observed);
    setup.model.detector.cut_after_direct_bins = 7;
    cut_direct_return(setup, capture);
    // Zone 1 sees the wall straight ahead up to a corner of its points.
    const core::ZoneFootprint zone = core::make_footprints(setup).zones[1];
    const double farthest =
        2.0 * *std::max_element(zone.seen.device_m.begin(), zone.seen.device_m.end());
    const int bin = static_cast<int>(farthest / capture.time_axis.bin_width_m);
    EXPECT_NEAR(capture.observed_range(1).begin, bin + 8, 1);
    EXPECT_EQ(capture.observed_range(1).end, 128);
    EXPECT_EQ(capture.transient.histogram(1)[40], 100.0F);
}

TEST(SensorCounts, DetectorIsThatOfTheDescription) {
    const core::SensorSetup setup = straight_sensor();
    const DetectorSettings settings = detector_of(setup);
    EXPECT_EQ(settings.exposure_s, setup.model.detector.frame_s);
    EXPECT_EQ(settings.response.jitter_fwhm_ps, 1000.0);
    EXPECT_NEAR(
        settings.radiometry.etendue_m2_sr, 0.5e-6 * core::zone_etendue_sr(setup.model), 1e-15);
    EXPECT_NO_THROW(validate(settings));
    for (const std::string& name : core::shipped_sensors()) {
        core::SensorSetup shipped = straight_sensor();
        shipped.model = core::read_sensor_model(name);
        EXPECT_NO_THROW(validate(detector_of(shipped))) << name;
    }
}

TEST(SensorCounts, OtherCapturesAreRefused) {
    const core::SensorSetup setup = straight_sensor();
    core::SensorSetup other = setup;
    other.model.zones = {4, 4};
    core::Capture capture = one_bright_zone(setup);
    EXPECT_ERROR_WITH(add_crosstalk(other, capture), "6 pairs for 16 zones");
}

TEST(Detector, FramesAreRecordedOneByOne) {
    const core::SensorSetup setup = straight_sensor();
    const core::Capture capture = one_bright_zone(setup);
    DetectorSettings settings;
    settings.photons = 30000.0;  // of a frame on average: 20000 and 40000
    settings.seed = test_support::seed_of("FramesAreRecordedOneByOne");
    const core::Capture counts = detect(capture, settings);
    ASSERT_TRUE(counts.sequence);
    ASSERT_EQ(counts.sequence->frames.size(), 2U);
    EXPECT_EQ(counts.sequence->frame_s, 0.04);
    EXPECT_NEAR(sum(counts.sequence->frames[0]), 20000.0, 5.0 * std::sqrt(20000.0));
    EXPECT_NEAR(sum(counts.sequence->frames[1]), 40000.0, 5.0 * std::sqrt(40000.0));
    EXPECT_EQ(sum(counts.transient), sum(counts.sequence->frames[1]));
}

}  // namespace
}  // namespace nlos
