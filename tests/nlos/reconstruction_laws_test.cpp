// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"
#include "renderer/core/system/parallel.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/nlos/methods/peak_fit.h"
#include "tests/nlos/reconstruction_law.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

// What must hold for every method on every kind of scan it serves: where points and their images
// are. Laws about how much light there is: reconstruction_light_laws_test.cpp.

namespace nlos {
namespace {

using core::ScanPattern;
using core::Vec3;
using nlos_test::brightest_point;
using nlos_test::kAxis;
using nlos_test::kPitch_m;
using nlos_test::LawCase;
using nlos_test::ReconstructionLaw;

TEST_P(ReconstructionLaw, APointBeforeAColumnIsBrightestAtItsPosition) {
    std::mt19937_64 generator(test_support::seed_of("APointBeforeAColumnIsBrightestAtItsPlace"));
    double sum = 0.0;
    for (int i = 0; i < GetParam().num_positions(); ++i) {
        const Vec3 scatterer = random_position(generator);
        core::Capture capture = dark_capture();
        nlos_test::add_scatterer(capture, scatterer, 4.0);
        const Vec3 found = brightest_point(run(capture));
        EXPECT_NEAR(found.x(), scatterer.x(), 1e-6) << scatterer.transpose();
        EXPECT_NEAR(found.y(), scatterer.y(), 1e-6) << scatterer.transpose();
        EXPECT_NEAR(found.z(), scatterer.z(), depth_tolerance_m(scatterer))
            << scatterer.transpose();
        sum += found.z() - scatterer.z();
    }
    // No method leans towards the wall or away from it.
    EXPECT_NEAR(sum / GetParam().num_positions(), 0.0, 0.05 * kAxis.bin_width_m);
}

// Bins about as wide in range as columns are apart, so that the image of a point, as wide as a bin,
// is not lost between columns. A column d beside the point shows it where the sphere around the
// wall point before it passes, d^2 / (2 z) nearer. The fit runs over columns up to d^2 = 2 pitch^2
// and may err by their bend. The image of a wave, a lobe as long as it is wide, widens with depth
// as its aperture shrinks to the eye: width ~ z, which moves the brightest place of a column
// d^2 / z away from the wall.
TEST_P(ReconstructionLaw, APointAnywhereIsBrightestAtItsPosition) {
    const core::TimeAxis axis{0.0, 0.048, 50};
    std::mt19937_64 generator(test_support::seed_of("APointAnywhereIsBrightestAtItsPlace"));
    std::uniform_real_distribution<double> lateral(-0.25, 0.25);
    std::uniform_real_distribution<double> depth(0.4, 0.75);
    for (int i = 0; i < GetParam().num_positions(); ++i) {
        const double x = lateral(generator);
        const double y = lateral(generator);
        const Vec3 scatterer(x, y, depth(generator));
        core::Capture capture = dark_capture(core::Transform::Identity(), axis);
        nlos_test::add_scatterer(capture, scatterer, 4.0);
        const Vec3 found = nlos_test::fitted_peak(run(capture, 66, {0.2, 1.0}).volume);
        EXPECT_NEAR(found.x(), scatterer.x(), lateral_tolerance_m()) << scatterer.transpose();
        EXPECT_NEAR(found.y(), scatterer.y(), lateral_tolerance_m()) << scatterer.transpose();
        const double bend =
            (GetParam().is_wave() ? 2.0 : 1.0) * kPitch_m * kPitch_m / scatterer.z();
        EXPECT_NEAR(found.z(), scatterer.z(), depth_tolerance_m(scatterer, axis) + bend)
            << scatterer.transpose();
    }
}

// With bins five times finer than columns, a point between columns is in none of them. Each pair of
// wall points says that its light came from where its ellipsoid passes a column, and these differ;
// the image lies somewhere among them. Needs an aperture: a narrow wall cannot tell which is
// nearest.
TEST_P(ReconstructionLaw, APointBetweenColumnsIsSeenWhereItsLightPassesTheNearest) {
    std::mt19937_64 generator(test_support::seed_of("APointBetweenColumnsIsSeen"));
    std::uniform_real_distribution<double> offset(-0.4, 0.4);
    for (int i = 0; i < GetParam().num_positions(); ++i) {
        const Vec3 column = random_position(generator);
        const double x = column.x() + offset(generator) * kPitch_m;
        const double y = column.y() + offset(generator) * kPitch_m;
        const Vec3 scatterer(x, y, column.z());
        core::Capture capture = dark_capture(core::Transform::Identity(), kAxis, 24);
        nlos_test::add_scatterer(capture, scatterer, 4.0);
        const Vec3 found = brightest_point(run(capture));
        EXPECT_NEAR(found.x(), column.x(), 1e-6) << scatterer.transpose();
        EXPECT_NEAR(found.y(), column.y(), 1e-6) << scatterer.transpose();
        const auto [nearest, farthest] = depths_of_light(capture.scan.wall(), scatterer, column);
        EXPECT_GT(found.z(), nearest - depth_tolerance_m(scatterer)) << scatterer.transpose();
        EXPECT_LT(found.z(), farthest + depth_tolerance_m(scatterer)) << scatterer.transpose();
    }
}

TEST_P(ReconstructionLaw, AMovedPointMovesItsImage) {
    const Vec3 scatterer(-0.06, 0.06, 0.55);
    const Vec3 step(2.0 * kPitch_m, -3.0 * kPitch_m, 5.0 * 0.008);
    core::Capture before = dark_capture();
    core::Capture after = dark_capture();
    nlos_test::add_scatterer(before, scatterer, 4.0);
    nlos_test::add_scatterer(after, scatterer + step, 4.0);
    EXPECT_LT((brightest_point(run(after)) - brightest_point(run(before)) - step).norm(),
              2.0 * depth_tolerance_m(scatterer));
}

TEST_P(ReconstructionLaw, AWallElsewhereGivesTheSameVolume) {
    core::Transform pose = core::Transform::Identity();
    pose.translate(Vec3(3.0, -2.0, 1.5));
    pose.rotate(Eigen::AngleAxisd(2.1, Vec3(0.3, 1.0, -0.2).normalized()));
    const Vec3 scatterer(0.06, -0.1, 0.55);
    core::Capture here = dark_capture();
    core::Capture there = dark_capture(pose);
    nlos_test::add_scatterer(here, scatterer, 4.0);
    nlos_test::add_scatterer(there, pose * scatterer, 4.0);
    const Reconstruction result = run(there);
    EXPECT_LT((brightest_point(result) - pose * brightest_point(run(here))).norm(), 1e-4);
}

TEST_P(ReconstructionLaw, TheAxisMayStartLate) {
    const Vec3 scatterer(0.06, -0.1, 0.55);
    core::Capture whole = dark_capture();
    core::Capture late = dark_capture();
    late.time_axis.opl_start_m = 0.7031;
    late.time_axis.num_bins = 100;
    late.transient = core::Transient(late.scan.num_pairs(), 100);
    nlos_test::add_scatterer(whole, scatterer, 4.0);
    nlos_test::add_scatterer(late, scatterer, 4.0);
    EXPECT_LT((brightest_point(run(late)) - brightest_point(run(whole))).norm(),
              2.0 * depth_tolerance_m(scatterer));
}

TEST_P(ReconstructionLaw, DeviceSegmentsAreTakenOff) {
    core::Capture capture = dark_capture();
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    capture.scan.wall().laser_position = Vec3(0.2, 0.3, -0.4);
    capture.scan.wall().detector_position = Vec3(-0.3, 0.1, -0.5);
    capture.time_axis.opl_start_m = 0.8;
    const Vec3 scatterer(0.06, -0.1, 0.55);
    nlos_test::add_scatterer(capture, scatterer, 4.0);
    const Vec3 found = brightest_point(run(capture));
    const auto [nearest, farthest] = depths_of_light(capture.scan.wall(), scatterer, found);
    EXPECT_LT((found - scatterer).head<2>().norm(), 0.5 * kPitch_m);
    EXPECT_GT(found.z(), nearest - depth_tolerance_m(scatterer));
    EXPECT_LT(found.z(), farthest + depth_tolerance_m(scatterer));
}

TEST_P(ReconstructionLaw, ALargerWorldGivesTheSameVolume) {
    const double factor = 2.0;  // a power of two: not even rounding differs
    core::Capture small = dark_capture();
    const Vec3 scatterer(0.06, -0.1, 0.55);
    nlos_test::add_scatterer(small, scatterer, 4.0);
    core::Capture large = small;
    large.time_axis.bin_width_m *= factor;
    for (core::WallPoints* points : {&large.scan.wall().sensing, &large.scan.wall().illumination}) {
        for (Vec3& position : points->positions) position *= factor;
    }
    const Reconstruction here = run(small);
    ReconstructSettings settings = here.settings;
    settings.volume.z_range_m = {factor * 0.3, factor * 0.9};
    settings.phasor.wavelength_m.reset();
    std::vector<float> there = reconstruct(large, settings, {}).volume.values;
    const float ratio =
        *std::ranges::max_element(here.volume.values) / *std::ranges::max_element(there);
    for (float& value : there) value *= ratio;
    EXPECT_LT(test_support::relative_l2(there, here.volume.values), 1e-5);
}

TEST_P(ReconstructionLaw, BitsAreTheSameForAnyNumberOfThreads) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, Vec3(0.06, -0.1, 0.55), 4.0);
    const auto values = [&](int threads) {
        const core::ThreadLimit limit(threads);
        return run(capture).volume.values;
    };
    EXPECT_EQ(values(1), values(7));
}

std::vector<LawCase> law_cases() {
    std::vector<LawCase> cases;
    for (auto& [method, pattern] : nlos_test::every_method_and_scan()) {
        const auto is_one_of = [&](std::initializer_list<const MethodTraits*> rows) {
            return std::ranges::find(rows, method.traits) != rows.end();
        };
        const bool is_linear = is_one_of({&kLct, &kFk, &kBp, &kFbp});
        if (method.iterates() && pattern == ScanPattern::Confocal) {
            method.overrides.push_back("solver.max_iterations=60");
        }
        cases.push_back({std::move(method), pattern, !is_one_of({&kFbp}), is_linear});
    }
    return cases;
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         ReconstructionLaw,
                         testing::ValuesIn(law_cases()),
                         [](const auto& law) { return law.param.method.name; });

}  // namespace
}  // namespace nlos
