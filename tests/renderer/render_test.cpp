// SPDX-License-Identifier: MIT
// What holds for every estimator: surfaces at one place count once, and it does not matter where in
// the world a scene stands.
#include "renderer/render.h"

#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/statistics.h"
#include "renderer/frame_sequence.h"
#include "tests/renderer/third_bounce/third_bounce_fixture.h"
#include "tests/support/error_message.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::Vec3;
using renderer::Estimator;
using renderer::Object;

const core::TimeAxis kRenderedAxis{1.2, 0.2, 20};

renderer::RenderSettings settings_of(Estimator estimator) {
    renderer::RenderSettings settings;
    settings.method = estimator;
    settings.samples = 64;
    return settings;
}

std::vector<Estimator> all_estimators() {
    std::vector<Estimator> all;
    for (std::size_t i = 0; i < renderer::kEstimators.size(); ++i) {
        all.push_back(static_cast<Estimator>(i));
    }
    return all;
}

/// A tilted panel, what hides a part of it, and a floor below that lights both.
std::vector<Object> example_objects() {
    std::vector<Object> objects{test_support::parallelogram_object(test_support::kTiltedPanel),
                                test_support::parallelogram_object(test_support::kBlackScreen),
                                test_support::parallelogram_object(
                                    {{-0.4, -0.4, 0.3}, {0.8, 0, 0.1}, {0, 0.05, 0.5}, 0.8})};
    for (std::size_t i = 0; i < objects.size(); ++i)
        objects[i].name = std::string(1, char('a' + i));
    return objects;
}

core::Scan wall_scan() {
    return test_support::exhaustive_scan({{-0.3, 0.1, 0}, {0.25, -0.2, 0}},
                                         test_support::kThreeWallPoints);
}

std::vector<float> render(const std::vector<Object>& objects,
                          const core::Scan& scan,
                          const renderer::RelayWall& wall,
                          Estimator estimator) {
    const renderer::Scene scene({objects, {}}, scan, wall);
    const renderer::RenderResult result =
        renderer::render(scene, scan, {kRenderedAxis, {}}, settings_of(estimator), {});
    const auto values = result.capture.transient.values();
    return {values.begin(), values.end()};
}

TEST(Render, WhatLiesAtOnePlaceCountsOnceByEveryEstimator) {
    std::vector<Object> doubled = example_objects();
    auto& faces = doubled[0].mesh.triangles;
    faces.push_back({faces[0][2], faces[0][1], faces[0][0]});  // a face once more, turned over
    Object copy = doubled[2];                                  // an object, cut by other diagonals
    copy.mesh.triangles = {{0, 1, 3}, {1, 2, 3}};
    copy.material.albedo = 0.1;
    doubled.push_back(copy);
    Object sheet = doubled[0];  // a tenth of a micrometre off
    for (Vec3& vertex : sheet.mesh.vertices) vertex.z() -= 1e-7;
    doubled.push_back(sheet);
    for (const Estimator estimator : all_estimators()) {
        EXPECT_EQ(render(doubled, wall_scan(), {}, estimator),
                  render(example_objects(), wall_scan(), {}, estimator))
            << renderer::traits_of(estimator).name;
    }
}

/// Beside them what rounding has most to decide of: seams of closed surfaces, which files set apart
/// by less than they round, and edges and sides of equal length.
std::vector<Object> objects_with_ties() {
    std::vector<Object> objects = example_objects();
    objects.push_back(third_bounce_test::box_object({-0.3, -0.3, 0.6}, {-0.1, -0.1, 0.8}));
    objects.emplace_back();
    objects.back().mesh = test_support::seamed_sphere({0.2, 0.2, 0.6}, 0.1, 12);
    return objects;
}

/// Some way off, by powers of two: of these, coordinates are not rounded much.
Vec3 way_of(double kilometres) {
    return 1000.0 * kilometres * Vec3(0.4375, 0.875, -0.1875);
}

double relative_difference(const std::vector<float>& values, const std::vector<float>& expected) {
    std::vector<float> difference;
    for (std::size_t i = 0; i < values.size(); ++i) difference.push_back(values[i] - expected[i]);
    return std::sqrt(core::squared_norm(difference) / core::squared_norm(expected));
}

void expect_the_same_elsewhere(const core::Scan& scan, const char* name) {
    for (const Estimator estimator : all_estimators()) {
        const renderer::EstimatorTraits& traits = renderer::traits_of(estimator);
        if (!scan.has_wall() && !traits.renders_images) continue;
        if (scan.as<core::SensorScan>() != nullptr && !traits.renders_sensors) continue;
        renderer::RelayWall wall;
        const std::vector<float> expected = render(objects_with_ties(), scan, wall, estimator);
        for (const double kilometres : {1.0, 10.0, 100.0, 1000.0}) {
            const Vec3 way = way_of(kilometres);
            std::vector<Object> objects = objects_with_ties();
            for (Object& object : objects) {
                for (Vec3& vertex : object.mesh.vertices) vertex += way;
            }
            wall.center_m = way;
            const auto values = render(objects, core::moved(scan, way), wall, estimator);
            // Rounding decides now and then on which side of an edge a pixel's sample falls.
            EXPECT_LT(relative_difference(values, expected), scan.has_wall() ? 1e-6 : 3e-3)
                << traits.name << ", " << name << ", " << kilometres << " km";
        }
    }
}

TEST(Render, ScansOfWallsAThousandKilometresAwayAreTheSame) {
    expect_the_same_elsewhere(wall_scan(), "exhaustive");
    expect_the_same_elsewhere(test_support::confocal_scan(test_support::kThreeWallPoints),
                              "confocal");
}

TEST(Render, ImagesAThousandKilometresAwayAreTheSame) {
    core::PinholeCamera camera;
    camera.position_m = {0.1, 0.2, -0.4};
    camera.look_at_m = {0, 0, 0.7};
    camera.resolution = {4, 3};
    expect_the_same_elsewhere(test_support::image_of(camera), "camera");
}

TEST(Render, SensorsAThousandKilometresAwayAreTheSame) {
    core::SensorSetup setup;
    setup.model.zones = {2, 2};
    setup.model.fov_deg = {30.0, 40.0};
    setup.pose = {Vec3(-0.35, 0.15, 0.8), Vec3(0.3, -0.1, -1.0), Vec3(0.1, 1.0, 0.0)};
    setup.subsamples = 1;
    expect_the_same_elsewhere(core::scan_of_zones(setup), "sensor");
}

TEST(Render, ResultsStayWhereTheSceneStands) {
    const Vec3 way = way_of(1000.0);
    std::vector<Object> objects = example_objects();
    for (Object& object : objects) {
        for (Vec3& vertex : object.mesh.vertices) vertex += way;
    }
    const core::Scan scan = core::moved(wall_scan(), way);
    renderer::RelayWall wall;
    wall.center_m = way;
    const auto scene =
        std::make_shared<const renderer::Scene>(renderer::SceneGeometry{objects, {}}, scan, wall);
    renderer::SceneDescription description;
    description.time_axis = {kRenderedAxis};
    description.frames = renderer::FrameSettings{2, 0.1, 0.0};
    for (const Estimator estimator : {Estimator::Path, Estimator::Restir}) {
        description.render = settings_of(estimator);
        const renderer::RenderResult one =
            renderer::render(*scene, scan, {kRenderedAxis, {}}, description.render, {});
        const renderer::RenderResult frames = renderer::render_frames(
            scene, scan, description, make_frame_renderer(scan, description.render), {});
        for (const core::Capture* capture : {&one.capture, &frames.capture}) {
            EXPECT_EQ(capture->scan.wall().sensing.positions, scan.wall().sensing.positions);
            EXPECT_FALSE(capture->transient.is_dark());
        }
    }
}

}  // namespace
