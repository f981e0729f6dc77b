// SPDX-License-Identifier: MIT
// Zones against sums over their footprints, written apart from the renderer.
#include "renderer/sensor_render.h"

#include "renderer/frame_sequence.h"
#include "renderer/render.h"
#include "tests/support/error_message.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace {

using core::SensorSetup;
using core::Vec3;
using test_support::Parallelogram;

// A small facet beside the wall's middle.
const Parallelogram kSmallFacet{{0.15, -0.1, 0.7}, {0.12, 0.02, 0.05}, {-0.02, 0.14, 0.03}, 0.7};
const core::TimeAxis kSensorAxis{1.8, 0.1, 24};
constexpr double kSensorWallAlbedo = 0.8;

// 2 x 2 zones that look at the wall obliquely, with the laser beside the lens.
SensorSetup oblique_sensor(core::SensorIllumination illumination) {
    SensorSetup setup;
    setup.model.zones = {2, 2};
    setup.model.fov_deg = {30.0, 40.0};
    setup.model.emitter_m = {0.02, -0.01};
    setup.model.illumination = illumination;
    setup.pose = {Vec3(-0.35, 0.15, 0.8), Vec3(0.3, -0.1, -1.0), Vec3(0.1, 1.0, 0.0)};
    setup.subsamples = 2;
    setup.wall.size_m = {2.0, 2.0};
    setup.wall.albedo = kSensorWallAlbedo;
    return setup;
}

renderer::Scene sensor_scene(std::vector<renderer::Object> objects, const SensorSetup& setup) {
    return renderer::Scene({std::move(objects), {}}, core::scan_of_zones(setup), setup.wall);
}

renderer::RenderSettings sensor_render_settings(renderer::Estimator method) {
    renderer::RenderSettings settings;
    settings.method = method;
    settings.seed = test_support::seed_of("SensorRender");
    if (method == renderer::Estimator::ThirdBounce) settings.target_error = 0.001;
    return settings;
}

core::Transient render_sensor(const std::vector<renderer::Object>& objects,
                              const SensorSetup& setup,
                              const renderer::RenderSettings& settings) {
    const renderer::Scene scene = sensor_scene(objects, setup);
    return renderer::render(scene, core::scan_of_zones(setup), {kSensorAxis, {}}, settings, {})
        .capture.transient;
}

// Rays of the sensor by hand: pinhole, zones by equal tangents, cosine powers.
struct Ray {
    Vec3 point;
    double cosine;  ///< to the sensor's axis
    Vec3 origin;
    int zone;
};

std::vector<Ray> rays_from(const Vec3& origin, const SensorSetup& setup) {
    const Vec3 f = setup.pose.forward.normalized();
    const Vec3 r = f.cross(setup.pose.up).normalized();
    const Vec3 u = r.cross(f);
    const double tx = std::tan(0.5 * setup.model.fov_deg[0] / core::kDegreesPerRadian);
    const double ty = std::tan(0.5 * setup.model.fov_deg[1] / core::kDegreesPerRadian);
    const int n = 2 * setup.subsamples;
    std::vector<Ray> rays;
    for (int row = 0; row < n; ++row) {
        for (int column = 0; column < n; ++column) {
            const Vec3 d = f + tx * ((2.0 * column + 1.0) / n - 1.0) * r +
                           ty * (1.0 - (2.0 * row + 1.0) / n) * u;
            rays.push_back({origin - origin.z() / d.z() * d,
                            1.0 / d.norm(),
                            origin,
                            2 * (row / setup.subsamples) + column / setup.subsamples});
        }
    }
    return rays;
}

// Radiance at s for 1 W on l that comes by the facet: bins of the path's length from the laser to
// the lens, by midpoints of the facet.
void add_third_bounce(const Ray& l, const Ray& s, double weight, std::vector<double>& histogram) {
    constexpr int kSteps = 12;
    const Vec3 area = kSmallFacet.u.cross(kSmallFacet.v);
    const Vec3 normal = area.normalized();
    const double segments = (l.point - l.origin).norm() + (s.point - s.origin).norm();
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const Vec3 p = kSmallFacet.corner + (i % kSteps + 0.5) / kSteps * kSmallFacet.u +
                       (i / kSteps + 0.5) / kSteps * kSmallFacet.v;
        const Vec3 a = l.point - p;
        const Vec3 b = s.point - p;
        const double value = std::pow(kSensorWallAlbedo / core::kPi, 2) * kSmallFacet.albedo /
                             core::kPi * area.norm() / (kSteps * kSteps) * (-a.z()) * (-b.z()) *
                             normal.dot(a) * normal.dot(b) /
                             std::pow(a.squaredNorm() * b.squaredNorm(), 2);
        const double bin = std::floor((segments + a.norm() + b.norm() - kSensorAxis.opl_start_m) /
                                      kSensorAxis.bin_width_m);
        if (normal.dot(a) * normal.dot(b) <= 0.0 || bin < 0 || bin >= kSensorAxis.num_bins)
            continue;
        histogram[static_cast<std::size_t>(bin)] += weight * value;
    }
}

std::vector<double> sum_over_footprints(const SensorSetup& setup) {
    const Vec3 f = setup.pose.forward.normalized();
    const Vec3 r = f.cross(setup.pose.up).normalized();
    const Vec3 laser = setup.pose.position_m + setup.model.emitter_m[0] * r +
                       setup.model.emitter_m[1] * r.cross(f);
    const auto lit = rays_from(laser, setup);
    const auto seen = rays_from(setup.pose.position_m, setup);
    std::array<double, 4> power{};
    double etendue = 0.0;
    for (const Ray& ray : lit) {
        power[static_cast<std::size_t>(ray.zone)] += std::pow(ray.cosine, 3);
        etendue += std::pow(ray.cosine, 4) / 4.0;
    }
    const double all = std::accumulate(power.begin(), power.end(), 0.0);
    const auto num_bins = static_cast<std::size_t>(kSensorAxis.num_bins);
    std::vector<double> zones;
    for (int zone = 0; zone < 4; ++zone) {
        std::vector<double> histogram(num_bins);
        for (const Ray& s : seen) {
            for (const Ray& l : lit) {
                const bool floods = setup.model.illumination == core::SensorIllumination::Flood;
                if (s.zone != zone || (!floods && l.zone != zone)) continue;
                const double total = floods ? all : power[static_cast<std::size_t>(zone)];
                add_third_bounce(l,
                                 s,
                                 std::pow(l.cosine, 3) / total * std::pow(s.cosine, 4) / etendue,
                                 histogram);
            }
        }
        zones.insert(zones.end(), histogram.begin(), histogram.end());
    }
    return zones;
}

double zones_error(const core::Transient& rendered, const std::vector<double>& expected) {
    double error = 0.0;
    double norm = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        error += std::pow(static_cast<double>(rendered.values()[i]) - expected[i], 2);
        norm += std::pow(expected[i], 2);
    }
    EXPECT_GT(norm, 0.0);
    return std::sqrt(error / norm);
}

double light_in(const core::Transient& transient) {
    return std::accumulate(transient.values().begin(), transient.values().end(), 0.0);
}

TEST(SensorRender, ThirdBounceIsTheSumOverFootprints) {
    for (const auto illumination :
         {core::SensorIllumination::Flood, core::SensorIllumination::Zones}) {
        const SensorSetup setup = oblique_sensor(illumination);
        const core::Transient zones =
            render_sensor({test_support::parallelogram_object(kSmallFacet)},
                          setup,
                          sensor_render_settings(renderer::Estimator::ThirdBounce));
        EXPECT_LT(zones_error(zones, sum_over_footprints(setup)), 0.01);
    }
}

TEST(SensorRender, PathsGiveTheSameWithinTheirNoise) {
    for (const auto illumination :
         {core::SensorIllumination::Flood, core::SensorIllumination::Zones}) {
        const SensorSetup setup = oblique_sensor(illumination);
        renderer::RenderSettings settings = sensor_render_settings(renderer::Estimator::Path);
        settings.samples = 256;
        const core::Transient zones =
            render_sensor({test_support::parallelogram_object(kSmallFacet)}, setup, settings);
        const std::vector<double> expected = sum_over_footprints(setup);
        EXPECT_LT(zones_error(zones, expected), 0.05);
        const double total = std::accumulate(expected.begin(), expected.end(), 0.0);
        EXPECT_NEAR(light_in(zones) / total, 1.0, 0.02);
    }
}

// The sum over a zone's points tends to the integral: halving the distance of points quarters what
// is missing.
TEST(SensorRender, SubsamplesConverge) {
    SensorSetup setup = oblique_sensor(core::SensorIllumination::Flood);
    const auto settings = sensor_render_settings(renderer::Estimator::ThirdBounce);
    std::vector<double> sums;
    for (const int n : {1, 2, 4}) {
        setup.subsamples = n;
        sums.push_back(light_in(
            render_sensor({test_support::parallelogram_object(kSmallFacet)}, setup, settings)));
    }
    EXPECT_NEAR(sums[1] / sums[2], 1.0, 0.02);
    EXPECT_LT(std::abs(sums[1] - sums[2]), 0.5 * std::abs(sums[0] - sums[2]));
}

// A retroreflector sends each point's light back to it: irradiance at the facet from the wall's
// radiance, all of it returned.
TEST(SensorRender, RetroreflectorsReturnWhatTheLaserSpreads) {
    SensorSetup setup = oblique_sensor(core::SensorIllumination::Flood);
    renderer::Object object = test_support::parallelogram_object(kSmallFacet);
    object.material.model = renderer::model_of({.retroreflective = true});
    renderer::Object black =
        test_support::parallelogram_object({{-0.4, 0.1, 0.9}, {0.1, 0, 0}, {0, 0.1, 0}, 0.0});
    std::vector<double> expected(4 * static_cast<std::size_t>(kSensorAxis.num_bins));
    const core::SensorFootprints footprints = core::make_footprints(setup);
    constexpr int kSteps = 12;
    const Vec3 area = kSmallFacet.u.cross(kSmallFacet.v);
    for (std::size_t zone = 0; zone < 4; ++zone) {
        const auto& seen = footprints.zones[zone].seen;
        for (std::size_t k = 0; k < seen.size() * kSteps * kSteps; ++k) {
            const Vec3& s = seen.positions[k / (kSteps * kSteps)];
            const auto i = static_cast<int>(k % (kSteps * kSteps));
            const Vec3 p = kSmallFacet.corner + (i % kSteps + 0.5) / kSteps * kSmallFacet.u +
                           (i / kSteps + 0.5) / kSteps * kSmallFacet.v;
            const Vec3 way = p - s;
            const double form = way.z() * std::abs(area.dot(way)) / (kSteps * kSteps) /
                                std::pow(way.squaredNorm(), 2);
            const double segments =
                (s - footprints.laser_m).norm() + (s - footprints.receiver_m).norm();
            const auto bin = kSensorAxis.bin_of(segments + 2.0 * way.norm());
            if (!bin) continue;
            expected[zone * static_cast<std::size_t>(kSensorAxis.num_bins) +
                     static_cast<std::size_t>(*bin)] +=
                seen.weights[k / (kSteps * kSteps)] *
                footprints.zones[zone].seen_irradiance[k / (kSteps * kSteps)] *
                std::pow(kSensorWallAlbedo / core::kPi, 2) * kSmallFacet.albedo * form;
        }
    }
    for (const auto method : {renderer::Estimator::ThirdBounce, renderer::Estimator::Path}) {
        renderer::RenderSettings settings = sensor_render_settings(method);
        settings.laser_spot_m2 = 1e-6;  // does not matter
        EXPECT_LT(zones_error(render_sensor({object, black}, setup, settings), expected),
                  method == renderer::Estimator::Path ? 0.1 : 0.02);
    }
    // Not even where laser and lens coincide do points count twice.
    setup.model.emitter_m = {0.0, 0.0};
    const auto settings = sensor_render_settings(renderer::Estimator::ThirdBounce);
    EXPECT_NEAR(light_in(render_sensor({object}, setup, settings)) /
                    std::accumulate(expected.begin(), expected.end(), 0.0),
                1.0,
                0.1);
}

TEST(SensorRender, DirectReturnIsThatOfALitWall) {
    const core::TimeAxis axis{0.0, 0.1, 40};
    SensorSetup setup = oblique_sensor(core::SensorIllumination::Flood);
    setup.model.zones = {1, 1};
    setup.model.fov_deg = {1.0, 1.0};
    setup.model.emitter_m = {0.0, 0.0};
    renderer::RenderSettings settings = sensor_render_settings(renderer::Estimator::ThirdBounce);
    settings.direct_return = true;
    settings.by_order = true;
    const renderer::Scene scene =
        sensor_scene({test_support::parallelogram_object(kSmallFacet)}, setup);
    const core::Capture capture =
        renderer::render(scene, core::scan_of_zones(setup), {axis, {}}, settings, {}).capture;
    const Vec3 f = setup.pose.forward.normalized();
    const double distance = 0.8 / -f.z();
    const double steradian = std::pow(1.0 / core::kDegreesPerRadian, 2);
    const double expected =
        kSensorWallAlbedo / core::kPi * -f.z() / (steradian * distance * distance);
    ASSERT_EQ(capture.orders.size(), 3U);
    EXPECT_NEAR(light_in(capture.by_order[0]) / expected, 1.0, 1e-3);
    EXPECT_EQ(light_in(capture.by_order[1]), 0.0);
    EXPECT_NEAR(light_in(capture.by_order[0]) + light_in(capture.by_order[2]),
                light_in(capture.transient),
                1e-5);
    const auto bin = static_cast<std::size_t>(*axis.bin_of(2.0 * distance));
    EXPECT_GT(capture.by_order[0].histogram(0)[bin], 0.5 * expected);
}

TEST(SensorRender, FramesFollowObjectsAndPoses) {
    SensorSetup setup = oblique_sensor(core::SensorIllumination::Flood);
    renderer::Object object = test_support::parallelogram_object(kSmallFacet);
    object.velocity_m_per_s = Vec3(1.0, 0.0, 0.0);
    setup.poses.assign(2, setup.pose);
    setup.poses[1].position_m += Vec3(0.1, 0.0, 0.0);  // along with the object
    renderer::SceneDescription description;
    description.relay_wall = setup.wall;
    description.relay_wall.size_m = {20.0, 20.0};
    setup.wall = description.relay_wall;
    description.time_axis = {kSensorAxis};
    description.frames = renderer::FrameSettings{2, 0.0, 0.1};
    description.render = sensor_render_settings(renderer::Estimator::ThirdBounce);
    const core::SensorScan scan = core::scan_of_zones(setup);
    const auto scene = std::make_shared<const renderer::Scene>(
        renderer::SceneGeometry{{object}, {}}, scan, setup.wall);
    const core::Capture capture =
        renderer::render_frames(
            scene, scan, description, renderer::make_frame_renderer(scan, description.render), {})
            .capture;
    ASSERT_EQ(capture.sequence->frames.size(), 2U);
    const auto first = capture.sequence->frames[0].values();
    const auto second = capture.sequence->frames[1].values();
    for (std::size_t i = 0; i < first.size(); ++i) {
        EXPECT_NEAR(first[i], second[i], 2e-3 * light_in(capture.transient));
    }
    EXPECT_NEAR(capture.scan.wall().detector_position.x() - scan.detector_position.x(), 0.1, 1e-12);
}

TEST(SensorRender, WhatItCannotDoIsRefused) {
    const SensorSetup setup = oblique_sensor(core::SensorIllumination::Flood);
    EXPECT_ERROR_WITH(render_sensor({test_support::parallelogram_object(kSmallFacet)},
                                    setup,
                                    sensor_render_settings(renderer::Estimator::Restir)),
                      "restir with a sensor");
    const renderer::Scene scene =
        sensor_scene({test_support::parallelogram_object(kSmallFacet)}, setup);
    EXPECT_ERROR_WITH(renderer::render(scene,
                                       core::scan_of_zones(setup),
                                       {kSensorAxis, core::VelocityAxis{}},
                                       sensor_render_settings(renderer::Estimator::Path),
                                       {}),
                      "velocity_axis");
}

}  // namespace
