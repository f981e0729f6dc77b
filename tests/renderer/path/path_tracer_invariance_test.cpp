// SPDX-License-Identifier: MIT
// What must not change when a set-up is described in another way.
#include "renderer/pass_render.h"
#include "renderer/path/path_tracer.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using core::Transform;
using core::Vec3;
using test_support::kThreeWallPoints;
using test_support::kTiltedPanel;
using test_support::Parallelogram;

const Parallelogram kOther{Vec3(0.2, -0.3, 0.5), Vec3(0.2, 0, 0.3), Vec3(0, 0.5, 0), 0.9};
const core::TimeAxis kInvarianceAxis{1.0, 0.02, 60};

renderer::RenderSettings settings_with(int samples) {
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::Path;
    settings.samples = samples;
    settings.max_bounces = 5;
    settings.variance = true;
    settings.seed = test_support::seed_of("Invariance");
    return settings;
}

core::Capture render_posed(const core::WallScan& scan,
                           const Transform& pose,
                           const core::TimeAxis& axis,
                           const renderer::RenderSettings& settings) {
    renderer::SceneGeometry geometry;
    for (const Parallelogram& shape : {kTiltedPanel, kOther}) {
        geometry.objects.push_back(test_support::parallelogram_object(shape));
        for (Vec3& vertex : geometry.objects.back().mesh.vertices) vertex = pose * vertex;
    }
    renderer::RelayWall wall;
    wall.center_m = pose * wall.center_m;
    wall.normal = pose.linear() * wall.normal;
    wall.up = pose.linear() * wall.up;
    core::WallScan posed = scan;
    for (core::WallPoints* points : {&posed.sensing, &posed.illumination}) {
        for (Vec3& position : points->positions) position = pose * position;
        for (Vec3& normal : points->normals) normal = pose.linear() * normal;
    }
    posed.laser_position = pose * scan.laser_position;
    posed.detector_position = pose * scan.detector_position;
    const renderer::Scene scene(std::move(geometry), posed, wall);
    return renderer::render(scene, posed, axis, settings, {}).capture;
}

core::Capture render_plain(const core::WallScan& scan,
                           const core::TimeAxis& axis,
                           const renderer::RenderSettings& settings) {
    return render_posed(scan, Transform::Identity(), axis, settings);
}

// The same random numbers in a rotated and far translated set-up draw the same paths; what is left
// is rounding that may push a path over a bin's edge or past an occluder's.
TEST(PathTracer, RotatedAndTranslatedSetUpGivesTheSameTransient) {
    Transform pose = Transform::Identity();
    pose.rotate(Eigen::AngleAxisd(0.9, Vec3(0.3, -0.5, 0.7).normalized()));
    pose.pretranslate(Vec3(1000.0, -300.0, 650.0));
    renderer::RenderSettings settings = settings_with(4000);
    settings.max_bounces = 3;
    const core::WallScan scan = test_support::confocal_scan(kThreeWallPoints);
    const core::TimeAxis axis{1.0, 0.008, 512};
    const auto plain = render_plain(scan, axis, settings);
    const auto posed = render_posed(scan, pose, axis, settings);
    EXPECT_LT(test_support::relative_l2(posed.transient.values(), plain.transient.values()), 1e-5);
}

TEST(PathTracer, DeviceOriginShiftsHistogramsByTheSegments) {
    core::WallScan scan = test_support::single_scan(Vec3(0.1, 0.2, 0.0), {kThreeWallPoints[0]});
    const auto wall_origin = render_plain(scan, kInvarianceAxis, settings_with(2000));
    scan.opl_origin = core::OplOrigin::Device;
    scan.laser_position = Vec3(-0.5, 0.1, 0.25);
    scan.detector_position = Vec3(0.4, 0.0, 0.3);
    core::TimeAxis shifted = kInvarianceAxis;
    shifted.opl_start_m += scan.device_segments_m(0);
    const auto device_origin = render_plain(scan, shifted, settings_with(2000));
    EXPECT_LT(
        test_support::relative_l2(device_origin.transient.values(), wall_origin.transient.values()),
        1e-3);
}

// Where pairs coincide, all patterns estimate the same histogram.
TEST(PathTracer, PatternsAgreeWherePairsCoincide) {
    const renderer::RenderSettings settings = settings_with(200'000);
    const auto exhaustive =
        render_plain(test_support::exhaustive_scan(kThreeWallPoints, kThreeWallPoints),
                     kInvarianceAxis,
                     settings);
    const auto confocal =
        render_plain(test_support::confocal_scan(kThreeWallPoints), kInvarianceAxis, settings);
    const auto single =
        render_plain(test_support::single_scan(kThreeWallPoints[1], kThreeWallPoints),
                     kInvarianceAxis,
                     settings);
    const auto expect_same = [&](const core::Capture& a,
                                 std::size_t pair,
                                 std::size_t of_exhaustive) {
        const std::size_t bins = a.transient.num_bins();
        const double level = test_support::sidak_level(1e-3, bins * 6);
        for (std::size_t bin = 0; bin < bins; ++bin) {
            const double difference = double{a.transient.histogram(pair)[bin]} -
                                      double{exhaustive.transient.histogram(of_exhaustive)[bin]};
            const double variance = double{a.variance->histogram(pair)[bin]} +
                                    double{exhaustive.variance->histogram(of_exhaustive)[bin]};
            if (variance == 0.0) continue;
            EXPECT_GT(test_support::normal_tail(difference / std::sqrt(variance)), level)
                << "pair " << pair << " bin " << bin;
        }
    };
    for (std::size_t i = 0; i < kThreeWallPoints.size(); ++i) {
        expect_same(confocal, i, i * kThreeWallPoints.size() + i);
        expect_same(single, i, kThreeWallPoints.size() + i);
    }
}

// Scans whose sums do not fit are traced in tiles; that changes no bit.
TEST(PathTracer, TilesGiveTheSameBitsAsTheWholeScan) {
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(test_support::parallelogram_object(kTiltedPanel));
    const core::WallScan scan = test_support::exhaustive_scan(kThreeWallPoints, kThreeWallPoints);
    const renderer::Scene scene(std::move(geometry), scan, renderer::RelayWall{});
    renderer::RenderSettings settings = settings_with(100);
    settings.by_order = true;
    renderer::PassWork work;
    work.tracer = std::make_shared<const renderer::PathTracer>(scene, settings);
    const auto whole = renderer::render_passes({scene, scan, kInvarianceAxis, settings, {}}, work);
    // Room for two pairs of five orders and squares.
    work.max_sums_bytes = 2.5 * 6 * 60 * sizeof(double);
    const auto tiled = renderer::render_passes({scene, scan, kInvarianceAxis, settings, {}}, work);
    EXPECT_TRUE(
        std::ranges::equal(tiled.capture.transient.values(), whole.capture.transient.values()));
    EXPECT_TRUE(
        std::ranges::equal(tiled.capture.variance->values(), whole.capture.variance->values()));
    EXPECT_TRUE(
        std::ranges::equal(tiled.capture.by_order[4].values(), whole.capture.by_order[4].values()));
    EXPECT_EQ(tiled.num_rays, whole.num_rays);
    core::Progress stop;
    stop.stop_requested = [] { return true; };
    EXPECT_THROW(renderer::render_passes({scene, scan, kInvarianceAxis, settings, stop}, work),
                 core::Failure);
}

// The direct return: radiance of the lit spot itself, after the device segments, confocal pairs
// only.
TEST(PathTracer, DirectReturnIsTheLitSpotAfterTheDeviceSegments) {
    renderer::RenderSettings settings = settings_with(16);
    settings.by_order = true;
    settings.direct_return = true;
    settings.laser_spot_m2 = 2e-4;
    core::WallScan scan = test_support::confocal_scan({kThreeWallPoints[0]});
    scan.opl_origin = core::OplOrigin::Device;
    scan.laser_position = scan.detector_position = Vec3(0.0, 0.0, 1.0);
    const core::TimeAxis axis{0.0, 0.02, 200};
    const auto capture = render_plain(scan, axis, settings);
    const auto direct = capture.by_order[0].histogram(0);
    const int bin = *axis.bin_of(2.0 * (kThreeWallPoints[0] - scan.laser_position).norm());
    for (int i = 0; i < axis.num_bins; ++i) {
        const double expected = i == bin ? 1.0 / (core::kPi * settings.laser_spot_m2) : 0.0;
        EXPECT_NEAR(direct[static_cast<std::size_t>(i)], expected, 1e-6 * (1.0 + expected)) << i;
    }
}

// Swapping light and sensor is the same path walked backwards.
TEST(PathTracer, SwappingLightAndSensorGivesTheSameEnergyPerOrder) {
    renderer::RenderSettings settings = settings_with(400'000);
    settings.by_order = true;
    const core::TimeAxis axis{0.0, 20.0, 1};
    const auto there = render_plain(
        test_support::single_scan(kThreeWallPoints[0], {kThreeWallPoints[2]}), axis, settings);
    const auto back = render_plain(
        test_support::single_scan(kThreeWallPoints[2], {kThreeWallPoints[0]}), axis, settings);
    for (const std::size_t order : {3U, 4U, 5U}) {
        const double a = double{there.by_order[order - 1].values()[0]};
        const double b = double{back.by_order[order - 1].values()[0]};
        EXPECT_GT(a, 0.0) << order;
        EXPECT_NEAR(a / b, 1.0, order == 3 ? 0.005 : 0.03) << order;
    }
}

// Which side of a plane a point within it lies on is rounding; a lobe and its density, each in its
// own frame, must not be asked.
TEST(RandomWalk, StepsWithinAPlaneCarryNothing) {
    core::Rng rng(test_support::seed_of("SurfaceWalk"), 0, 0);
    const core::WallScan scan = test_support::confocal_scan(kThreeWallPoints);
    for (int i = 0; i < 100; ++i) {
        const Parallelogram shape{Vec3(-0.3, -0.2, 0.6),
                                  Vec3(0.5, rng.uniform(), 0.4 * rng.uniform()),
                                  Vec3(-0.1, 0.5, rng.uniform())};
        const renderer::Scene scene(
            {{test_support::parallelogram_object(shape)}, {}}, scan, renderer::RelayWall{});
        const renderer::RandomWalk walk(scene, 1e-4);
        const auto point = [&] {
            const double u = rng.uniform();
            return renderer::SurfacePoint{scene.facet(0).point(u, (1.0 - u) * rng.uniform()), 0};
        };
        renderer::PathVertex vertex;
        vertex.point = point();
        vertex.normal = scene.facet(0).normal;
        vertex.to_previous = vertex.normal;
        vertex.bsdf = scene.bsdf_at(vertex.point);
        vertex.throughput = 1.0;
        EXPECT_FALSE(walk.step_to(vertex, point()).has_value());
        const renderer::SurfacePoint above{vertex.point.position + 0.1 * vertex.normal, 1};
        EXPECT_TRUE(walk.step_to(vertex, above).has_value());
    }
}

}  // namespace
