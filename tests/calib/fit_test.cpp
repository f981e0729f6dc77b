// SPDX-License-Identifier: MIT
// Fits as a whole: known scenes come back, and what the data cannot tell is said.
#include "calib/fit.h"

#include "calib/compare_fit.h"
#include "calib/fit/fit_data.h"
#include "calib/fit/fit_objective.h"
#include "calib/fit_file.h"
#include "renderer/core/system/output_file.h"
#include "renderer/core/system/parallel.h"
#include "tests/support/error_message.h"
#include "tests/support/fit_examples.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using core::Vec3;
using test_support::confocal_grid;
using test_support::counted;
using test_support::expected_capture;
using test_support::fit_input;
using test_support::tilted_rectangle;

renderer::SceneGeometry scene_at(const Vec3& center, double tilt_rad) {
    renderer::SceneGeometry geometry;
    geometry.objects = {tilted_rectangle("target", center, tilt_rad)};
    return geometry;
}

const renderer::SceneGeometry& truth() {
    static const renderer::SceneGeometry kTruth = scene_at(Vec3(0.05, -0.02, 0.8), 0.44);
    return kTruth;
}

const renderer::SceneGeometry& displaced() {
    static const renderer::SceneGeometry kStart = scene_at(Vec3(0.0, 0.04, 0.72), 0.15);
    return kStart;
}

TEST(Fit, FindsThePoseOfNoiseFreeData) {
    const auto capture = expected_capture(truth(), confocal_grid(8), 1e6, 0.5);
    calib::FitInput input = fit_input(capture, displaced());
    input.settings.residual = calib::ResidualKind::LeastSquares;
    input.settings.element_tolerance = 5e-3;
    const calib::FitResult fit = calib::fit_scene(input, {});
    ASSERT_TRUE(fit.converged);
    const auto errors = calib::compare_fit(fit, fit.geometry, truth());
    EXPECT_LT(*errors.position_m, 2e-4);
    EXPECT_LT(*errors.rotation_deg, 0.1);
    EXPECT_NEAR(fit.estimates["ambient"].value, 0.5, 5e-3);
}

// Where rounding of the coordinates alone is 0.1 um, against sigmas of half a millimetre.
TEST(Fit, FindsTheSameAThousandKilometresAway) {
    const auto capture = counted(expected_capture(truth(), confocal_grid(6), 500.0, 0.5), "far");
    calib::FitInput input = fit_input(capture, displaced());
    const calib::FitResult here = calib::fit_scene(input, {});
    const Vec3 way(4e5, -1e6, 7e5);
    input.capture.scan = core::moved(input.capture.scan, way);
    input.geometry.move(way);
    const calib::FitResult there = calib::fit_scene(input, {});
    ASSERT_TRUE(here.converged && there.converged);
    const calib::FittedObject& expected = here.objects.front();
    const calib::FittedObject& object = there.objects.front();
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(object.position_m[i] - way[i],
                    expected.position_m[i],
                    0.05 * expected.position_sigma_m[i]);
        EXPECT_NEAR(object.position_sigma_m[i],
                    expected.position_sigma_m[i],
                    0.02 * expected.position_sigma_m[i]);
    }
    EXPECT_LT((there.geometry.objects[0].mesh.vertices[0] - way -
               here.geometry.objects[0].mesh.vertices[0])
                  .norm(),
              1e-4);
    EXPECT_NEAR(there.deviance, here.deviance, 0.1);
    EXPECT_EQ(there.warnings, here.warnings);
}

TEST(Fit, FindsPoseAndAlbedoOfRadianceWithoutAmbientLight) {
    core::Capture capture = expected_capture(truth(), confocal_grid(8), 1.0, 0.0);
    capture.unit = core::TransientUnit::Radiance;
    calib::FitInput input = fit_input(capture, displaced());
    input.settings.free.parameters.clear();
    const calib::FitResult fit = calib::fit_scene(input, {});
    ASSERT_TRUE(fit.converged);
    EXPECT_EQ(fit.residual, "least_squares");
    EXPECT_EQ(fit.estimates["scale"].value, 1.0);
    EXPECT_LT(*calib::compare_fit(fit, fit.geometry, truth()).position_m, 1e-3);
    EXPECT_GT(fit.objects[0].numbers["albedo"].sigma, 0.0);
}

// Two rectangles below one node, which is freed by its name.
renderer::SceneGeometry group_at(const Vec3& position, double turn_rad) {
    core::Transform world_from_group = core::Transform::Identity();
    world_from_group.translate(position).rotate(Eigen::AngleAxisd(turn_rad, Vec3::UnitY()));
    renderer::SceneGeometry geometry;
    geometry.objects = {tilted_rectangle("left", Vec3(-0.12, 0.05, 0.0), 0.3),
                        tilted_rectangle("right", Vec3(0.15, -0.02, 0.1), -0.2)};
    for (renderer::Object& object : geometry.objects) {
        for (Vec3& vertex : object.mesh.vertices) vertex = world_from_group * vertex;
        object.world_from_node = world_from_group * object.world_from_node;
        object.groups = {{"pair", world_from_group}};
    }
    return geometry;
}

TEST(Fit, AGroupMovesAsOneBody) {
    const auto truth_of_pair = group_at(Vec3(0.03, 0.0, 0.8), 0.2);
    const auto capture = expected_capture(truth_of_pair, confocal_grid(8), 1e6, 0.5);
    calib::FitInput input = fit_input(capture, group_at(Vec3(0.0, 0.03, 0.76), 0.1));
    input.settings.free.objects.front().name = "pair";
    input.settings.residual = calib::ResidualKind::LeastSquares;
    const calib::FitResult fit = calib::fit_scene(input, {});
    ASSERT_TRUE(fit.converged);
    ASSERT_EQ(fit.objects.size(), 1U);
    EXPECT_EQ(fit.objects[0].name, "pair");
    EXPECT_LT((fit.objects[0].position_m - Vec3(0.03, 0.0, 0.8)).norm(), 1e-3);
    const auto errors = calib::compare_fit(fit, fit.geometry, truth_of_pair);
    EXPECT_LT(*errors.position_m, 1e-3);
    EXPECT_LT(*errors.rotation_deg, 0.3);
    for (std::size_t o = 0; o < 2; ++o) {
        const renderer::Object& object = fit.geometry.objects[o];
        EXPECT_LT((object.groups[0].world_from_node.translation() - Vec3(0.03, 0.0, 0.8)).norm(),
                  1e-3);
        EXPECT_LT((object.world_from_node.translation() -
                   truth_of_pair.objects[o].world_from_node.translation())
                      .norm(),
                  1e-3);
    }
    // Its parts are no bodies of their own then.
    input.settings.free.objects.push_back(input.settings.free.objects.front());
    input.settings.free.objects.back().name = "left";
    EXPECT_ERROR_WITH(calib::fit_scene(input, {}), "found 'pair' and 'left', which is in it");
    input.settings.free.objects = {input.settings.free.objects.front()};
    input.settings.free.objects.front().name = "pear";
    EXPECT_ERROR_WITH(calib::fit_scene(input, {}), "pair, left, right");
}

// A gate that holds the light of the target but not all of it, for every pair another, and dead
// points: what nobody saw is no darkness.
TEST(Fit, LeavesOutBinsThatWereNotObserved) {
    core::Capture capture = counted(expected_capture(truth(), confocal_grid(8), 1e6, 2.0), "Gates");
    std::vector<core::BinRange> ranges;
    for (int pair = 0; pair < 64; ++pair) {
        const int begin = 22 + pair % 7;
        ranges.push_back(pair % 5 == 0 ? core::BinRange{} : core::BinRange{begin, begin + 45});
    }
    core::restrict_observed(capture, ranges);
    const calib::FitResult fit = calib::fit_scene(fit_input(capture, displaced()), {});
    ASSERT_TRUE(fit.converged);
    EXPECT_LT(*calib::compare_fit(fit, fit.geometry, truth()).position_m, 0.001);
    EXPECT_NEAR(fit.estimates["ambient"].value, 2.0, 5.0 * fit.estimates["ambient"].sigma);
    EXPECT_NEAR(fit.deviance, fit.expected_deviance, 5.0 * fit.expected_deviance_sigma);
    EXPECT_LT(fit.num_observed(), 52U * 45U + 1U);
    capture.observed.reset();
    const calib::FitResult dark = calib::fit_scene(fit_input(capture, displaced()), {});
    EXPECT_GT(dark.deviance, dark.expected_deviance + 100.0 * dark.expected_deviance_sigma);
}

TEST(Fit, FewerPairsCostAccuracyThatIsReported) {
    const auto capture = counted(expected_capture(truth(), confocal_grid(16), 1e5, 1.0), "Fewer");
    calib::FitInput input = fit_input(capture, displaced());
    const calib::FitResult all = calib::fit_scene(input, {});
    input.settings.max_pairs = 64;
    const calib::FitResult few = calib::fit_scene(input, {});
    EXPECT_EQ(4 * few.data.size(), all.data.size());
    const double ratio =
        few.objects[0].position_sigma_m.norm() / all.objects[0].position_sigma_m.norm();
    EXPECT_NEAR(ratio, 2.0, 0.3);
    EXPECT_LT(*calib::compare_fit(few, few.geometry, truth()).position_m, 0.006);
}

TEST(Fit, ReportedErrorsMatchTrueOnesAndDevianceItsExpectation) {
    const auto expected = expected_capture(truth(), confocal_grid(8), 1e5, 5.0);
    double squared = 0.0;
    constexpr int kFits = 12;
    for (int i = 0; i < kFits; ++i) {
        const auto capture = counted(expected, ("StatedErrors" + std::to_string(i)));
        calib::FitInput input = fit_input(capture, truth());
        input.settings.blur_schedule_m = {0.0};
        const calib::FitResult fit = calib::fit_scene(input, {});
        ASSERT_TRUE(fit.converged);
        const Vec3 error = fit.objects[0].position_m - Vec3(0.05, -0.02, 0.8);
        squared += error.cwiseQuotient(fit.objects[0].position_sigma_m).squaredNorm();
        EXPECT_NEAR(fit.deviance, fit.expected_deviance, 5.0 * fit.expected_deviance_sigma);
    }
    EXPECT_GT(test_support::chi_square_tail(squared, 3.0 * kFits), 1e-4);
    EXPECT_LT(test_support::chi_square_tail(squared, 3.0 * kFits), 1.0 - 1e-4);
}

TEST(Fit, SearchNeedsNoStart) {
    const auto capture = counted(expected_capture(truth(), confocal_grid(8), 3e4, 1.0), "Search");
    calib::FitInput input = fit_input(capture, scene_at(Vec3(0.3, 0.3, 0.4), 0.0));
    input.settings.start = "search";
    const calib::FitResult fit = calib::fit_scene(input, {});
    EXPECT_EQ(fit.starts.size(), 10U);
    const auto errors = calib::compare_fit(fit, fit.geometry, truth());
    EXPECT_LT(*errors.position_m, 0.01);
    EXPECT_LT(*errors.rotation_deg, 5.0);
}

TEST(Fit, GivesTheSameBitsForAnyNumberOfThreads) {
    const auto capture = counted(expected_capture(truth(), confocal_grid(6), 2e4, 1.0), "Bits");
    const auto run = [&](int threads) {
        const core::ThreadLimit limit(threads);
        return calib::fit_scene(fit_input(capture, displaced()), {});
    };
    const calib::FitResult one = run(1);
    const calib::FitResult seven = run(7);
    EXPECT_EQ(one.objects[0].position_m, seven.objects[0].position_m);
    EXPECT_EQ(one.objects[0].rotation.coeffs(), seven.objects[0].rotation.coeffs());
    EXPECT_EQ(one.deviance, seven.deviance);
}

TEST(Fit, TimeZeroWithoutPriorIsReportedAsTiedToDepth) {
    const auto capture = counted(expected_capture(truth(), confocal_grid(8), 1e5, 1.0), "Zero");
    calib::FitInput input = fit_input(capture, truth());
    input.settings.free.parameters.insert("time_zero");
    const calib::FitResult free = calib::fit_scene(input, {});
    EXPECT_TRUE(test_support::mentions(free.unidentifiable, "time_zero"));
    input.settings.free.prior_sigma["time_zero"] = 0.0006;
    const calib::FitResult held = calib::fit_scene(input, {});
    EXPECT_LT(held.objects[0].position_sigma_m.z(), 0.5 * free.objects[0].position_sigma_m.z());
}

TEST(Fit, CountsOfUnknownScaleKeepOneAlbedoAndSayIt) {
    const auto capture = expected_capture(truth(), confocal_grid(6), 1e5, 0.1);
    const calib::FitResult fit = calib::fit_scene(fit_input(capture, displaced()), {});
    EXPECT_EQ(fit.objects[0].numbers["albedo"].value, 0.5);
    EXPECT_TRUE(test_support::mentions(fit.unidentifiable, "scale with target.albedo"));
}

TEST(Fit, LeastSquaresReportsTheScaleThatItEliminates) {
    core::Capture capture = counted(expected_capture(truth(), confocal_grid(8), 1e6, 0.5), "Scale");
    capture.counts_per_radiance.reset();
    calib::FitInput input = fit_input(capture, displaced());
    const calib::FitResult poisson = calib::fit_scene(input, {});
    input.settings.residual = calib::ResidualKind::LeastSquares;
    const calib::FitResult squares = calib::fit_scene(input, {});
    EXPECT_GT(squares.estimates["scale"].sigma, 0.0);
    EXPECT_NEAR(squares.estimates["scale"].value / poisson.estimates["scale"].value, 1.0, 0.02);
}

TEST(Fit, RobustLossRejectsWildWallPoints) {
    core::Capture capture =
        counted(expected_capture(truth(), confocal_grid(8), 1e5, 1.0), "Outliers");
    for (const std::size_t pair : {3U, 17U, 40U}) {
        for (float& value : capture.transient.histogram(pair)) value += 20.0F;
    }
    calib::FitInput input = fit_input(capture, truth());
    const double plain =
        (calib::fit_scene(input, {}).objects[0].position_m - Vec3(0.05, -0.02, 0.8)).norm();
    input.settings.loss = calib::LossKind::Cauchy;
    const double robust =
        (calib::fit_scene(input, {}).objects[0].position_m - Vec3(0.05, -0.02, 0.8)).norm();
    EXPECT_LT(robust, 0.004);
    EXPECT_LT(robust, plain);
}

TEST(Fit, PointScatterersAreFoundFromNothing) {
    const std::vector<Vec3> points{Vec3(-0.2, 0.1, 0.6), Vec3(0.2, -0.15, 0.7)};
    renderer::SceneGeometry geometry;
    for (const Vec3& p : points) {
        geometry.objects.push_back(test_support::parallelogram_object(
            {p - Vec3(0.005, 0.005, 0.0), Vec3(0.01, 0, 0), Vec3(0, 0.01, 0), 1.0}));
        geometry.objects.back().name = "patch" + std::to_string(geometry.objects.size());
    }
    const auto capture = counted(expected_capture(geometry, confocal_grid(8), 1e5, 0.2), "Points");
    calib::FitInput input = fit_input(capture, truth());
    input.geometry.objects.clear();
    input.settings.free.objects.clear();
    input.settings.free.point_scatterers = 2;
    input.settings.start = "search";
    const calib::FitResult fit = calib::fit_scene(input, {});
    ASSERT_EQ(fit.points.size(), 2U);
    for (const Vec3& p : points) {
        const double nearest =
            std::min((fit.points[0].position_m - p).norm(), (fit.points[1].position_m - p).norm());
        EXPECT_LT(nearest, 0.01);
    }
}

TEST(Fit, AStartBehindTheWallIsRefused) {
    const auto capture = expected_capture(truth(), confocal_grid(4), 1e4, 0.1);
    EXPECT_ERROR_WITH(calib::fit_scene(fit_input(capture, scene_at(Vec3(0.0, 0.0, -0.5), 0.1)), {}),
                      "behind the relay wall");
}

TEST(Fit, UnknownNodeNamesListTheKnownOnes) {
    const auto capture = expected_capture(truth(), confocal_grid(4), 1e4, 0.1);
    calib::FitInput input = fit_input(capture, truth());
    input.settings.free.objects.front().name = "teapot";
    EXPECT_ERROR_WITH(calib::fit_scene(input, {}), "target");
}

TEST(Fit, FileKeepsWhatTheFitFound) {
    const auto capture = expected_capture(truth(), confocal_grid(4), 1e4, 0.1);
    const calib::FitResult fit = calib::fit_scene(fit_input(capture, displaced()), {});
    const test_support::TemporaryFolder folder;
    core::write_text_file(folder.file("fit.json"), calib::fit_json(fit).dump());
    EXPECT_TRUE(calib::is_fit_file(folder.file("fit.json")));
    const calib::FitResult read = calib::read_fit(folder.file("fit.json"));
    EXPECT_EQ(read.objects[0].position_m, fit.objects[0].position_m);
    EXPECT_EQ(read.objects[0].position_sigma_m, fit.objects[0].position_sigma_m);
    EXPECT_EQ(read.converged, fit.converged);
}

TEST(Fit, RotationIsComparedModuloSymmetry) {
    renderer::SceneGeometry turned = truth();
    renderer::Object& object = turned.objects[0];
    object.world_from_node.linear() =
        object.world_from_node.linear() *
        Eigen::AngleAxisd(core::kPi, Vec3::UnitZ()).toRotationMatrix();
    calib::FitResult fit;
    fit.objects.emplace_back();
    fit.objects[0].name = "target";
    EXPECT_LT(*calib::compare_fit(fit, turned, truth()).rotation_deg, 1e-6);
    object.world_from_node.linear() =
        object.world_from_node.linear() *
        Eigen::AngleAxisd(core::kPi / 2.0, Vec3::UnitZ()).toRotationMatrix();
    EXPECT_NEAR(*calib::compare_fit(fit, turned, truth()).rotation_deg, 90.0, 1e-6);
}

TEST(FitData, ThinningKeepsPairsAndPointsTogether) {
    const core::WallScan scan = confocal_grid(16);
    const calib::PairSubset subset = calib::thin(scan, 50);
    EXPECT_LE(subset.pairs.size(), 50U);
    EXPECT_GE(subset.pairs.size(), 16U);
    for (std::size_t i = 0; i < subset.pairs.size(); ++i) {
        EXPECT_EQ(subset.scan.sensing.positions[i], scan.sensing.positions[subset.pairs[i]]);
    }
}

}  // namespace
