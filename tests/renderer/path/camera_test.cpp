// SPDX-License-Identifier: MIT
// Images of a pinhole camera against closed forms and against scans of the same paths.
#include "renderer/core/system/parallel.h"
#include "renderer/path/sensor_pairs.h"
#include "tests/support/error_message.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using core::kPi;
using core::Vec3;
using test_support::image_of;
using test_support::Parallelogram;

const Parallelogram kFloor{Vec3(-2, -2, 0), Vec3(4, 0, 0), Vec3(0, 4, 0), 0.6};

core::PinholeCamera camera_at(const Vec3& position, const Vec3& look_at) {
    core::PinholeCamera camera;
    camera.position_m = position;
    camera.look_at_m = look_at;
    camera.resolution = {8, 6};
    return camera;
}

// One pixel so narrow that what it sees is a point.
core::PinholeCamera narrow_camera(const Vec3& position, const Vec3& look_at) {
    core::PinholeCamera camera = camera_at(position, look_at);
    camera.fov_y_deg = 1e-4;
    camera.resolution = {1, 1};
    return camera;
}

renderer::RenderSettings settings_with(int samples, int max_bounces) {
    renderer::RenderSettings settings;
    settings.samples = samples;
    settings.max_bounces = max_bounces;
    settings.variance = true;
    settings.by_order = true;
    settings.seed = test_support::seed_of("Camera");
    return settings;
}

renderer::Scene scene_with(const std::vector<renderer::Object>& objects, const core::Scan& scan) {
    return renderer::Scene({objects, {}}, scan, {});
}

core::Capture render_image(const std::vector<renderer::Object>& objects,
                           const core::PinholeCamera& camera,
                           const core::TimeAxis& axis,
                           const renderer::RenderSettings& settings) {
    const core::Scan scan = image_of(camera);
    return renderer::render(scene_with(objects, scan), scan, axis, settings, {}).capture;
}

TEST(PinholeCamera, ImageIsRightHandedFromTheTopLeft) {
    core::PinholeCamera camera = camera_at(Vec3(0, 0, 5), Vec3(0, 0, 1));
    camera.fov_y_deg = 90.0;
    const core::Mat3 world_from_image = camera.world_from_image();
    // A square of pixels at the image's height of 2 and distance 1: width 8/6 of it.
    EXPECT_LT((world_from_image * Vec3(0, 0, 1) - Vec3(-8.0 / 6.0, 1, -1)).norm(), 1e-12);
    EXPECT_LT((world_from_image * Vec3(8, 6, 1) - Vec3(8.0 / 6.0, -1, -1)).norm(), 1e-12);
    EXPECT_LT((world_from_image * Vec3(4, 3, 1) - Vec3(0, 0, -1)).norm(), 1e-12);
}

TEST(PinholeCamera, UpNeedsNotBeAcrossTheView) {
    core::PinholeCamera camera = camera_at(Vec3(0, 0, 5), Vec3(0, 0, 1));
    const core::Mat3 expected = camera.world_from_image();
    camera.up = Vec3(0.0, 3.0, -2.0);
    EXPECT_LT((camera.world_from_image() - expected).norm(), 1e-12);
}

// radiance = albedo/pi cos / (4 pi d^2), averaged over the pixel.
TEST(Camera, DirectLightOnAPlaneIsTheClosedForm) {
    core::PinholeCamera camera = camera_at(Vec3(0.1, -0.2, 1.5), Vec3(0.3, 0.2, 0.0));
    camera.light_m = Vec3(-0.4, 0.3, 0.8);
    const auto capture = render_image({test_support::parallelogram_object(kFloor)},
                                      camera,
                                      {0.0, 20.0, 1},
                                      settings_with(1 << 13, 1));
    const core::Mat3 world_from_image = camera.world_from_image();
    const double level = test_support::sidak_level(1e-3, camera.num_pixels());
    constexpr int kSteps = 64;
    for (std::size_t pixel = 0; pixel < camera.num_pixels(); ++pixel) {
        const auto x = static_cast<double>(pixel / 6);
        const auto y = static_cast<double>(pixel % 6);
        double expected = 0.0;
        for (int i = 0; i < kSteps * kSteps; ++i) {
            const Vec3 direction =
                world_from_image *
                Vec3(x + (i / kSteps + 0.5) / kSteps, y + (i % kSteps + 0.5) / kSteps, 1.0);
            const Vec3 seen = camera.position_m - camera.position_m.z() / direction.z() * direction;
            const Vec3 to_light = *camera.light_m - seen;
            const double cosine = to_light.z() / to_light.norm();
            expected += kFloor.albedo / kPi * cosine / (4.0 * kPi * to_light.squaredNorm());
        }
        expected /= kSteps * kSteps;
        const double found = double{capture.transient.histogram(pixel)[0]};
        const double deviation = std::sqrt(double{capture.variance->histogram(pixel)[0]});
        EXPECT_GT(test_support::normal_tail((found - expected) / deviation), level) << pixel;
        EXPECT_NEAR(found / expected, 1.0, 0.01) << pixel;
    }
}

TEST(Camera, WholeLengthFromLightToCameraCounts) {
    const Vec3 seen(0.25, -0.1, 0.0);
    core::PinholeCamera camera = narrow_camera(Vec3(0.1, -0.2, 1.5), seen);
    const core::TimeAxis axis{0.0, 1e-3, 5000};
    for (const auto& light : {std::optional<Vec3>(), std::optional(Vec3(-0.4, 0.3, 0.8))}) {
        camera.light_m = light;
        const auto capture = render_image(
            {test_support::parallelogram_object(kFloor)}, camera, axis, settings_with(16, 1));
        const Vec3 to_light = light.value_or(camera.position_m) - seen;
        const int bin = *axis.bin_of((camera.position_m - seen).norm() + to_light.norm());
        const double expected =
            kFloor.albedo / kPi * to_light.normalized().z() / (4.0 * kPi * to_light.squaredNorm());
        const auto histogram = capture.transient.histogram(0);
        EXPECT_NEAR(histogram[static_cast<std::size_t>(bin)] / expected, 1.0, 1e-4);
        EXPECT_NEAR(test_support::sum_of(histogram) / expected, 1.0, 1e-4)
            << "all of it in one bin";
    }
}

TEST(Camera, LitSpotCountsAsABounceAndSendsItsAlbedoOn) {
    // Whichever way the lit facet is oriented, its lit side faces the camera.
    const Parallelogram side{Vec3(-1, -2, 0), Vec3(0, 4, 0), Vec3(0, 0, 2), 0.8};
    const Parallelogram turned{side.corner, side.v, side.u, side.albedo};
    const Vec3 seen(0.25, -0.1, 0.0);
    core::PinholeCamera camera = narrow_camera(Vec3(0.1, -0.2, 1.5), seen);
    camera.light_spot_m = Vec3(-1.0, 0.3, 0.7);
    const core::TimeAxis axis{0.0, 1e-3, 5000};
    const Vec3 to_spot = *camera.light_spot_m - seen;
    const Vec3 direction = to_spot.normalized();
    const double expected = kFloor.albedo / kPi * direction.z() * side.albedo / kPi *
                            -direction.x() / to_spot.squaredNorm();
    const int bin = *axis.bin_of((camera.position_m - seen).norm() + to_spot.norm());
    for (const Parallelogram& lit : {side, turned}) {
        const auto capture = render_image(
            {test_support::parallelogram_object(kFloor), test_support::parallelogram_object(lit)},
            camera,
            axis,
            settings_with(16, 2));
        EXPECT_EQ(test_support::sum_of(capture.by_order[0].values()), 0.0);
        const auto histogram = capture.by_order[1].histogram(0);
        EXPECT_NEAR(histogram[static_cast<std::size_t>(bin)] / expected, 1.0, 1e-4);
        EXPECT_NEAR(test_support::sum_of(histogram) / expected, 1.0, 1e-4);
    }
}

TEST(Camera, SpotBesideEverySurfaceIsRefused) {
    core::PinholeCamera camera = camera_at(Vec3(0, 0, 1), Vec3::Zero());
    camera.light_spot_m = Vec3(0.5, 0.5, 0.01);
    const core::Scan scan = image_of(camera);
    const renderer::Scene scene = scene_with({test_support::parallelogram_object(kFloor)}, scan);
    EXPECT_ERROR_WITH(renderer::SensorPairs(scene, scan), "camera.light_spot_m");
}

// A perfect mirror shows the lit floor as if seen from behind it.
TEST(Camera, MirrorShowsTheFloorAtItsMirroredLength) {
    renderer::Object mirror =
        test_support::parallelogram_object({Vec3(1, -2, 0), Vec3(0, 4, 0), Vec3(0, 0, 2), 1.0});
    mirror.material.model = renderer::model_of({.metallic = true});
    mirror.material.roughness = 0.03;
    const Vec3 eye(0.2, 0.0, 0.9);
    const Vec3 seen(0.4, 0.2, 0.0);
    const Vec3 mirrored(1.6, 0.2, 0.0);
    core::PinholeCamera camera = narrow_camera(eye, mirrored);
    camera.light_m = Vec3(0.3, 0.5, 1.4);
    const auto capture = render_image({test_support::parallelogram_object(kFloor), mirror},
                                      camera,
                                      {0.0, 0.01, 600},
                                      settings_with(20'000, 2));
    const Vec3 to_light = *camera.light_m - seen;
    const double expected =
        kFloor.albedo / kPi * to_light.normalized().z() / (4.0 * kPi * to_light.squaredNorm());
    const auto histogram = capture.by_order[1].histogram(0);
    EXPECT_NEAR(test_support::sum_of(histogram) / expected, 1.0, 0.01);
    const auto peak = std::max_element(histogram.begin(), histogram.end()) - histogram.begin();
    EXPECT_NEAR(
        (static_cast<double>(peak) + 0.5) * 0.01, (mirrored - eye).norm() + to_light.norm(), 0.011);
}

// A sphere with light and camera inside: bounce k has radiance albedo^k / (4 pi^2 R^2) everywhere.
TEST(Camera, FurnaceShowsTheSameRadianceInEveryPixel) {
    constexpr double kRadius = 1.0;
    constexpr double kAlbedo = 0.7;
    core::PinholeCamera camera = camera_at(Vec3(0.3, -0.2, 0.1), Vec3(0.5, 0.4, 1.0));
    camera.resolution = {3, 2};
    camera.light_m = Vec3::Zero();
    const auto capture =
        render_image({test_support::sphere_object(Vec3::Zero(), kRadius, 5, kAlbedo)},
                     camera,
                     {0.0, 100.0, 1},
                     settings_with(20'000, 4));
    for (int order = 1; order <= 4; ++order) {
        const double expected = std::pow(kAlbedo, order) / (4.0 * kPi * kPi * kRadius * kRadius);
        for (std::size_t pixel = 0; pixel < 6; ++pixel) {
            const auto& of_order = capture.by_order[static_cast<std::size_t>(order - 1)];
            EXPECT_NEAR(of_order.histogram(pixel)[0] / expected, 1.0, 0.015)
                << "order " << order << " pixel " << pixel;
        }
    }
}

// Radiance that leaves a wall point does not depend on who looks: a pixel that sees it and a scan
// measure the same, the length of the camera's segment apart.
TEST(Camera, AgreesWithAScanOfTheSamePoints) {
    const Vec3 lit(0.1, 0.05, 0.0);
    const Vec3 seen(-0.2, 0.1, 0.0);
    const Parallelogram hidden{Vec3(-0.3, -0.2, 0.7), Vec3(0.5, 0, 0.2), Vec3(0, 0.4, 0), 0.8};
    const Parallelogram other{Vec3(0.3, -0.3, 0.3), Vec3(0.1, 0, 0.3), Vec3(0, 0.6, 0), 0.9};
    const Parallelogram wall{Vec3(-0.5, -0.5, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), 0.7};
    const std::vector<renderer::Object> objects{test_support::parallelogram_object(hidden),
                                                test_support::parallelogram_object(other)};
    const core::TimeAxis axis{1.2, 0.05, 40};
    renderer::RenderSettings settings = settings_with(1'600'000, 5);

    const core::Scan scan = test_support::single_scan(lit, {seen});
    renderer::RelayWall relay_wall;
    relay_wall.albedo = wall.albedo;
    const renderer::Scene scan_scene({objects, {}}, scan, relay_wall);
    const auto scanned = renderer::render(scan_scene, scan, axis, settings, {}).capture;

    core::PinholeCamera camera = narrow_camera(Vec3(-0.9, 0.1, 0.3), seen);
    camera.light_spot_m = lit;
    core::TimeAxis later = axis;
    later.opl_start_m += (camera.position_m - seen).norm();
    std::vector<renderer::Object> with_wall = objects;
    with_wall.push_back(test_support::parallelogram_object(wall));
    settings.seed += 1;
    const auto image = render_image(with_wall, camera, later, settings);

    const double level = test_support::sidak_level(1e-3, static_cast<std::size_t>(axis.num_bins));
    int tested = 0;
    for (std::size_t bin = 0; bin < 40; ++bin) {
        const double variance =
            double{image.variance->values()[bin]} + double{scanned.variance->values()[bin]};
        if (variance == 0.0) continue;
        const double difference =
            double{image.transient.values()[bin]} - double{scanned.transient.values()[bin]};
        EXPECT_GT(test_support::normal_tail(difference / std::sqrt(variance)), level) << bin;
        ++tested;
    }
    EXPECT_GT(tested, 20);
    for (const std::size_t order : {3U, 4U, 5U}) {
        EXPECT_NEAR(test_support::sum_of(image.by_order[order - 1].values()) /
                        test_support::sum_of(scanned.by_order[order - 1].values()),
                    1.0,
                    0.03)
            << order;
    }
}

TEST(Camera, BinsAndOrdersSumToTheSteadyState) {
    const std::vector<renderer::Object> objects{
        test_support::parallelogram_object(kFloor),
        test_support::sphere_object(Vec3(0.2, 0.1, 0.3), 0.2, 2, 0.9)};
    const core::PinholeCamera camera = camera_at(Vec3(0.1, -0.9, 1.0), Vec3(0.1, 0.1, 0.1));
    const auto settings = settings_with(64, 4);
    const auto bins = render_image(objects, camera, {0.0, 0.05, 400}, settings);
    const auto steady = render_image(objects, camera, {0.0, 20.0, 1}, settings);
    for (std::size_t pixel = 0; pixel < camera.num_pixels(); ++pixel) {
        const double total = test_support::sum_of(bins.transient.histogram(pixel));
        double orders = 0.0;
        for (const auto& order : bins.by_order)
            orders += test_support::sum_of(order.histogram(pixel));
        EXPECT_GT(total, 0.0);
        EXPECT_NEAR(steady.transient.histogram(pixel)[0] / total, 1.0, 1e-5);
        EXPECT_NEAR(orders / total, 1.0, 1e-5);
    }
}

TEST(Camera, ThreadsChangeNoBit) {
    const std::vector<renderer::Object> objects{
        test_support::parallelogram_object(kFloor),
        test_support::sphere_object(Vec3(0.2, 0.1, 0.3), 0.2, 2, 0.9)};
    const core::PinholeCamera camera = camera_at(Vec3(0.1, -0.9, 1.0), Vec3(0.1, 0.1, 0.1));
    const auto with_threads = [&](int count) {
        const core::ThreadLimit threads(count);
        return render_image(objects, camera, {0.0, 0.05, 100}, settings_with(32, 4));
    };
    const core::Capture one = with_threads(1);
    const core::Capture seven = with_threads(7);
    EXPECT_TRUE(std::ranges::equal(one.transient.values(), seven.transient.values()));
    EXPECT_TRUE(std::ranges::equal(one.variance->values(), seven.variance->values()));
}

TEST(Camera, ThirdBounceIsRefused) {
    auto settings = settings_with(8, 3);
    settings.method = renderer::Estimator::ThirdBounce;
    EXPECT_ERROR_WITH(render_image({test_support::parallelogram_object(kFloor)},
                                   camera_at(Vec3(0, 0, 1), Vec3::Zero()),
                                   {0.0, 1.0, 4},
                                   settings),
                      "third_bounce for a camera");
}

// A relay wall of a scan's scene is a surface like any other to a camera.
TEST(Camera, RelayWallIsAnOrdinarySurface) {
    renderer::Object wall = test_support::parallelogram_object(kFloor);
    const core::PinholeCamera camera = camera_at(Vec3(0, 0, 1), Vec3(0.1, 0, 0));
    const auto plain = render_image({wall}, camera, {0.0, 20.0, 1}, settings_with(8, 3));
    wall.role = renderer::Role::RelayWall;
    const auto relay = render_image({wall}, camera, {0.0, 20.0, 1}, settings_with(8, 3));
    EXPECT_TRUE(std::ranges::equal(plain.transient.values(), relay.transient.values()));
}

}  // namespace
