// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/nlos/reconstruction_law.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

// What must hold for every method however the same measurement is stored: in a list or a grid, in
// which order, with how many empty bins around the light, in bins of which width.

namespace nlos {
namespace {

using core::Vec3;
using core::WallPoints;
using nlos_test::brightest_point;
using nlos_test::kAxis;
using nlos_test::kColumns;
using nlos_test::kPitch_m;
using nlos_test::ReconstructionLaw;

const Vec3 kStoredPoint(0.06, -0.1, 0.55);

/// The capture with the histogram of sensing point order[i] in place i, as a grid of that size.
core::Capture stored_in_order(const core::Capture& capture,
                              const std::vector<std::size_t>& order,
                              const std::optional<std::array<std::size_t, 2>>& grid) {
    core::Capture stored = capture;
    core::WallScan& scan = stored.scan.wall();
    const core::WallScan& from = capture.scan.wall();
    for (std::size_t i = 0; i < order.size(); ++i) {
        scan.sensing.positions[i] = from.sensing.positions[order[i]];
        scan.sensing.normals[i] = from.sensing.normals[order[i]];
    }
    scan.sensing.grid = grid;
    if (scan.is_confocal()) scan.illumination = scan.sensing;
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        const std::size_t lit = pair / order.size();
        std::ranges::copy(
            capture.transient.histogram(lit * order.size() + order[pair % order.size()]),
            stored.transient.histogram(pair).begin());
    }
    return stored;
}

/// Numbers of the points of a square grid, x before y, with an axis reversed or both exchanged.
std::vector<std::size_t> square_order(bool is_reversed, bool is_exchanged) {
    std::vector<std::size_t> order;
    for (std::size_t a = 0; a < kColumns; ++a) {
        for (std::size_t b = 0; b < kColumns; ++b) {
            const std::size_t first = is_reversed ? kColumns - 1 - a : a;
            order.push_back(is_exchanged ? b * kColumns + first : first * kColumns + b);
        }
    }
    return order;
}

TEST_P(ReconstructionLaw, AListOfPointsIsTheGridThatTheyFill) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, kStoredPoint, 4.0);
    const Reconstruction expected = run(capture);
    std::vector<std::size_t> order = square_order(false, false);
    std::mt19937_64 generator(test_support::seed_of("AListOfPointsIsTheGridThatTheyFill"));
    for (int i = 0; i < 2; ++i) {  // in the grid's order, and in none
        const Reconstruction result = run(stored_in_order(capture, order, std::nullopt));
        EXPECT_EQ(result.volume.values, expected.volume.values);
        EXPECT_EQ(result.depth.depth_m.size(), expected.depth.depth_m.size());
        EXPECT_EQ(result.points.positions, expected.points.positions);
        std::ranges::shuffle(order, generator);
    }
}

TEST_P(ReconstructionLaw, AMirroredOrExchangedGridShowsTheSameScene) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, kStoredPoint, 4.0);
    const Vec3 expected = brightest_point(run(capture));
    for (const bool is_reversed : {false, true}) {
        for (const bool is_exchanged : {false, true}) {
            const core::Capture stored = stored_in_order(
                capture, square_order(is_reversed, is_exchanged), std::array{kColumns, kColumns});
            EXPECT_LT((brightest_point(run(stored)) - expected).norm(), 1e-4)
                << is_reversed << is_exchanged;
        }
    }
}

// Points moved by a thousandth of their distance stay a grid, and the image where it is.
TEST_P(ReconstructionLaw, PointsNearlyOnAGridAreOnIt) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, kStoredPoint, 4.0);
    const Reconstruction expected = run(capture);
    std::mt19937_64 generator(test_support::seed_of("PointsNearlyOnAGridAreOnIt"));
    std::uniform_real_distribution<double> step(-1e-3 * kPitch_m, 1e-3 * kPitch_m);
    for (Vec3& position : capture.scan.wall().sensing.positions) {
        position += Vec3(step(generator), step(generator), 0.0);
    }
    if (capture.scan.wall().is_confocal()) {
        capture.scan.wall().illumination = capture.scan.wall().sensing;
    }
    const Reconstruction result =
        run(stored_in_order(capture, square_order(true, true), std::nullopt));
    EXPECT_LT((brightest_point(result) - brightest_point(expected)).norm(), 1e-3 * kPitch_m);
    EXPECT_LT(test_support::relative_l2(result.volume.values, expected.volume.values), 0.01);
}

// The sphere around each wall point on which light may have come from grows by the same length: a
// voxel fits best that is at least so much farther, and at most as far as the farthest wall point
// has it.
TEST_P(ReconstructionLaw, AShiftInTimeIsAShiftInDepth) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, kStoredPoint, 4.0);
    const Vec3 before = brightest_point(run(capture));
    const double shift_m = 2.0 * kAxis.bin_width_m;
    capture.time_axis.opl_start_m += shift_m;
    const Vec3 after = brightest_point(run(capture));
    const double farthest = std::hypot(kStoredPoint.z(), kColumns * kPitch_m) / kStoredPoint.z();
    EXPECT_GT(after.z() - before.z(), 0.5 * shift_m - 2.0 * depth_tolerance_m(kStoredPoint));
    EXPECT_LT(after.z() - before.z(),
              0.5 * shift_m * farthest + 2.0 * depth_tolerance_m(kStoredPoint));
    EXPECT_LT((after - before).head<2>().norm(), lateral_tolerance_m());
}

TEST_P(ReconstructionLaw, TwiceTheBinsShowTheSameScene) {
    const core::TimeAxis fine{kAxis.opl_start_m, 0.5 * kAxis.bin_width_m, 2 * kAxis.num_bins};
    core::Capture coarse = dark_capture();
    core::Capture twice = dark_capture(core::Transform::Identity(), fine);
    nlos_test::add_scatterer(coarse, kStoredPoint, 4.0);
    nlos_test::add_scatterer(twice, kStoredPoint, 4.0);
    EXPECT_LT((brightest_point(run(twice)) - brightest_point(run(coarse))).norm(),
              2.0 * depth_tolerance_m(kStoredPoint));
}

// Default settings: a range of depths that is asked for is looked at whole.
TEST_P(ReconstructionLaw, EmptyBinsBehindTheLightChangeNoSurface) {
    if (GetParam().pattern != core::ScanPattern::Confocal) return;
    std::vector<core::DepthMap> depths;
    for (const int more : {0, 64, 300}) {
        core::Capture capture = dark_capture(core::Transform::Identity(),
                                             {0.0, kAxis.bin_width_m, kAxis.num_bins + more});
        nlos_test::add_scatterer(capture, kStoredPoint, 4.0);
        depths.push_back(reconstruct(capture, GetParam().method.settings(), {}).depth);
    }
    for (const core::DepthMap& depth : depths) {
        for (std::size_t i = 0; i < depth.depth_m.size(); ++i) {
            ASSERT_EQ(depth.is_foreground(i), depths.front().is_foreground(i)) << i;
            if (!depth.is_foreground(i)) continue;
            EXPECT_NEAR(depth.depth_m[i], depths.front().depth_m[i], 1e-3);
        }
    }
}

}  // namespace
}  // namespace nlos
