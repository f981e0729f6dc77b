// SPDX-License-Identifier: MIT
#include "renderer/core/capture/sensor_footprint.h"

#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace {

using core::SensorFootprints;
using core::SensorSetup;
using core::Vec3;

// 3 x 2 zones of 40 x 30 degrees, 1.2 m straight before a wall that holds all they see.
SensorSetup straight_setup() {
    SensorSetup setup;
    setup.model.zones = {3, 2};
    setup.model.fov_deg = {40.0, 30.0};
    setup.pose.position_m = Vec3(0.1, -0.2, 1.2);
    setup.wall.size_m = {4.0, 4.0};
    setup.subsamples = 8;
    return setup;
}

SensorSetup oblique_setup() {
    SensorSetup setup = straight_setup();
    setup.pose.forward = Vec3(0.5, 0.2, -1.0);
    setup.pose.up = Vec3(0.2, 1.0, 0.1);
    return setup;
}

double sum_of_weights(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

// Of a pyramid with these full angles, by the formula for its apex.
double pyramid_solid_angle(double a_deg, double b_deg) {
    return 4.0 * std::asin(std::sin(0.5 * a_deg / core::kDegreesPerRadian) *
                           std::sin(0.5 * b_deg / core::kDegreesPerRadian));
}

TEST(SensorFootprint, ZonesAreNumberedAsTheSensorSeesThem) {
    const SensorFootprints footprints = core::make_footprints(straight_setup());
    ASSERT_EQ(footprints.zones.size(), 6U);
    // Looking along -z with y up, x runs to the right.
    const double x = 1.2 * std::tan(20.0 / core::kDegreesPerRadian);
    const double y = 1.2 * std::tan(15.0 / core::kDegreesPerRadian);
    const Vec3 first = *footprints.zones[0].center_m;
    EXPECT_NEAR((first - Vec3(0.1 - 2.0 / 3.0 * x, -0.2 + 0.5 * y, 0.0)).norm(), 0.0, 1e-12);
    const Vec3 last = *footprints.zones[5].center_m;
    EXPECT_NEAR((last - Vec3(0.1 + 2.0 / 3.0 * x, -0.2 - 0.5 * y, 0.0)).norm(), 0.0, 1e-12);
}

TEST(SensorFootprint, SubsamplesAreCentresOfEqualParts) {
    const SensorFootprints footprints = core::make_footprints(straight_setup());
    const core::PatchPoints& seen = footprints.zones[0].seen;
    ASSERT_EQ(seen.size(), 64U);
    const double step = 2.0 * 1.2 * std::tan(20.0 / core::kDegreesPerRadian) / 24.0;
    EXPECT_NEAR((seen.positions[1] - seen.positions[0] - Vec3(step, 0, 0)).norm(), 0.0, 1e-12);
    EXPECT_NEAR(seen.device_m[0], (seen.positions[0] - Vec3(0.1, -0.2, 1.2)).norm(), 1e-12);
}

TEST(SensorFootprint, LightIsSpreadEvenlyOverTheSolidAngle) {
    SensorSetup setup = straight_setup();
    setup.model.zones = {1, 1};
    setup.subsamples = 1;
    const SensorFootprints one = core::make_footprints(setup);
    EXPECT_NEAR(one.zones[0].lit.weights[0], 1.0, 1e-12);
    EXPECT_NEAR(one.zones[0].seen_irradiance[0], 1.0 / (pyramid_solid_angle(40, 30) * 1.44), 1e-9);
    for (const SensorSetup& many : {straight_setup(), oblique_setup()}) {
        double lit = 0.0;
        double seen = 0.0;
        const SensorFootprints footprints = core::make_footprints(many);
        for (const auto& zone : footprints.zones) {
            lit += sum_of_weights(zone.lit.weights);
            seen += sum_of_weights(zone.seen.weights);
        }
        EXPECT_NEAR(lit, 1.0, 1e-12);
        EXPECT_NEAR(seen, 6.0, 1e-12);
    }
}

TEST(SensorFootprint, ZoneOfItsOwnLightGetsAllOfIt) {
    SensorSetup setup = oblique_setup();
    const SensorFootprints flood = core::make_footprints(setup);
    setup.model.illumination = core::SensorIllumination::Zones;
    const SensorFootprints own = core::make_footprints(setup);
    for (std::size_t zone = 0; zone < 6; ++zone) {
        const double fraction = sum_of_weights(flood.zones[zone].lit.weights);
        EXPECT_NEAR(sum_of_weights(own.zones[zone].lit.weights), 1.0, 1e-12);
        EXPECT_NEAR(flood.zones[zone].seen_irradiance[5] / fraction,
                    own.zones[zone].seen_irradiance[5],
                    1e-9);
    }
}

// The irradiance times the area of a part, from its own corners, is the fraction of the light.
TEST(SensorFootprint, IrradianceIsLightPerArea) {
    SensorSetup setup = oblique_setup();
    setup.subsamples = 40;
    SensorSetup fine = setup;
    fine.subsamples = 80;  // its points 2i and 2i + 1 span half a part of the coarse grid
    const core::ZoneFootprint zone = core::make_footprints(setup).zones[1];
    const std::vector<Vec3> points = core::make_footprints(fine).zones[1].seen.positions;
    for (const std::size_t i : {0U, 17U, 39U}) {
        const std::size_t corner = 2 * 80 * 5 + 2 * i;
        const Vec3 u = points[corner + 1] - points[corner];
        const Vec3 v = points[corner + 80] - points[corner];
        const double area = 4.0 * u.cross(v).norm();
        const std::size_t part = 40 * 5 + i;
        EXPECT_NEAR(zone.seen_irradiance[part] * area / zone.lit.weights[part], 1.0, 2e-3);
    }
}

TEST(SensorFootprint, EtendueFallsOffWithTheCosine) {
    // All of a hemisphere is pi; a field of 170 x 170 degrees comes close to it.
    core::SensorModel model;
    model.fov_deg = {170.0, 170.0};
    model.zones = {1, 1};
    EXPECT_NEAR(core::zone_etendue_sr(model), core::kPi, 0.03);
    model.fov_deg = {2.0, 2.0};
    EXPECT_NEAR(core::zone_etendue_sr(model), pyramid_solid_angle(2, 2), 1e-6);
}

TEST(SensorFootprint, RotatesWithTheWorld) {
    const SensorSetup setup = oblique_setup();
    core::Transform turn = core::Transform::Identity();
    turn.rotate(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()));
    turn.pretranslate(Vec3(3, -1, 2));
    SensorSetup turned = setup;
    turned.pose.position_m = turn * setup.pose.position_m;
    turned.pose.forward = turn.linear() * setup.pose.forward;
    turned.pose.up = turn.linear() * setup.pose.up;
    turned.wall.center_m = turn * setup.wall.center_m;
    turned.wall.normal = turn.linear() * setup.wall.normal;
    turned.wall.up = turn.linear() * setup.wall.up;
    const SensorFootprints before = core::make_footprints(setup);
    const SensorFootprints after = core::make_footprints(turned);
    for (std::size_t zone = 0; zone < 6; ++zone) {
        const auto& a = before.zones[zone].seen;
        const auto& b = after.zones[zone].seen;
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
            EXPECT_NEAR((turn * a.positions[i] - b.positions[i]).norm(), 0.0, 1e-9);
            EXPECT_EQ(a.weights[i], b.weights[i]);
        }
    }
}

TEST(SensorFootprint, ZonesThatMissTheWallAreDead) {
    SensorSetup setup = straight_setup();
    setup.wall.center_m = Vec3(-1.0, 0.0, 0.0);
    setup.wall.size_m = {2.0, 4.0};  // ends at x = 0, where the left column is alone
    const SensorFootprints footprints = core::make_footprints(setup);
    EXPECT_EQ(footprints.num_dead(), 2U);
    EXPECT_TRUE(footprints.zones[2].is_dead());
    EXPECT_FALSE(footprints.zones[2].center_m);
    const auto& partial = footprints.zones[1].seen;
    EXPECT_GT(partial.size(), 0U);
    EXPECT_LT(partial.size(), 64U);

    const core::SensorScan scan = core::scan_of_zones(setup);
    EXPECT_EQ(scan.num_pairs(), 6U);
    EXPECT_EQ(scan.sensing.positions[5], setup.wall.center_m);
    core::Capture capture;
    capture.scan = scan;
    capture.time_axis = {0.0, 0.1, 4};
    capture.transient = core::Transient(6, 4);
    core::observe_live_zones(setup, capture);
    EXPECT_EQ(capture.observed_range(5).size(), 0);
    EXPECT_EQ(capture.observed_range(0).size(), 4);
}

TEST(SensorFootprint, PoseThatSeesNothingIsRefusedInOneLine) {
    SensorSetup setup = straight_setup();
    setup.pose.forward = Vec3::UnitZ();
    EXPECT_ERROR_WITH(core::make_footprints(setup), "no zone sees the relay wall");
    setup = straight_setup();
    setup.pose.position_m.z() = -1.2;
    setup.pose.forward = Vec3::UnitZ();
    EXPECT_ERROR_WITH(core::make_footprints(setup), "front of the wall");
    setup = straight_setup();
    setup.pose.up = setup.pose.forward;
    EXPECT_ERROR_WITH(core::validate(setup, "sensor"), "sensor.pose.up");
    setup = straight_setup();
    setup.subsamples = 0;
    EXPECT_ERROR_WITH(core::validate(setup, "sensor"), "sensor.subsamples");
}

TEST(SensorFootprint, SetupIsReadFromProvenance) {
    SensorSetup setup = oblique_setup();
    setup.poses = {setup.pose, setup.pose};
    setup.poses[1].position_m.x() = 0.5;
    core::Capture capture;
    EXPECT_FALSE(core::recorded_sensor(capture));
    capture.scene_info["sensor"] = core::write_value(setup);
    const auto recorded = core::recorded_sensor(capture);
    ASSERT_TRUE(recorded);
    EXPECT_EQ(recorded->model.zones, setup.model.zones);
    EXPECT_EQ(recorded->pose_of_frame(1).position_m.x(), 0.5);
    capture.scene_info["sensor"]["model"]["zones"] = {0, 1};
    EXPECT_ERROR_WITH(core::recorded_sensor(capture), "scene_info.sensor.model.zones");
}

}  // namespace
