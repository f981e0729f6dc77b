// SPDX-License-Identifier: MIT
// What every method makes of a gate that holds the object and of dead points.
#include "nlos/detector/detector.h"
#include "nlos/reconstruct.h"
#include "tests/nlos/every_method.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/error_message.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace nlos {
namespace {

using core::BinRange;
using core::ScanPattern;
using core::Vec3;

constexpr std::size_t kWallColumns = 24;
constexpr double kWallPitch_m = 0.04;
constexpr std::size_t kNumZ = 38;
const Vec3 kPosition(0.06, -0.1, 0.55);
const BinRange kGate{60, 132};  // half the bins, with all light of the object

constexpr double kGhosts = 0.05;  // that dead points may add off the object, of its brightness

class ObservedReconstruction
    : public testing::TestWithParam<std::pair<nlos_test::MethodCase, ScanPattern>> {
 protected:
    static core::Capture whole_capture() {
        core::Capture capture = nlos_test::confocal_capture(
            nlos_test::wall_grid({kWallColumns, kWallColumns}, {kWallPitch_m, kWallPitch_m}),
            {0.0, 0.016, 144});
        capture.scan.wall().pattern = GetParam().second;
        if (capture.scan.wall().pattern == ScanPattern::Single) {
            capture.scan.wall().illumination = nlos_test::wall_grid({1, 1}, {1.0, 1.0});
        }
        if (capture.scan.wall().pattern == ScanPattern::Exhaustive) {
            capture.scan.wall().illumination = nlos_test::wall_grid({2, 1}, {0.4, 0.4});
        }
        capture.transient = core::Transient(capture.scan.num_pairs(), 144);
        nlos_test::add_scatterer(capture, kPosition, 4.0);
        return capture;
    }

    /// The gate, and 30 % of the points dead: a fifth of the wall along one side, others anywhere.
    static void mask(core::Capture& capture) {
        std::mt19937_64 generator(test_support::seed_of("DeadPoints"));
        std::bernoulli_distribution is_dead(0.125);
        std::vector<BinRange> of_point;
        for (std::size_t i = 0; i < capture.scan.wall().sensing.size(); ++i) {
            const bool is_aside = i / kWallColumns < kWallColumns / 5;
            of_point.push_back(is_aside || is_dead(generator) ? BinRange{} : kGate);
        }
        std::vector<BinRange> ranges;
        for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
            ranges.push_back(of_point[capture.scan.wall().sensing_index(pair)]);
        }
        core::restrict_observed(capture, ranges);
    }

    static Reconstruction run(const core::Capture& capture) {
        ReconstructSettings settings = GetParam().first.settings();
        settings.volume = {std::array{24, 24, static_cast<int>(kNumZ)}, std::array{0.4, 0.704}};
        return reconstruct(capture, settings, {});
    }

    /// Brightness away from the object, of the brightest voxel's.
    static double ghosts(const Volume& volume) {
        constexpr double kReach_m = 0.12;
        const double top = *std::ranges::max_element(volume.values);
        double most = 0.0;
        for (std::size_t ix = 0; ix < kWallColumns; ++ix) {
            for (std::size_t iy = 0; iy < kWallColumns; ++iy) {
                for (std::size_t iz = 0; iz < kNumZ; ++iz) {
                    const Vec3 p(volume.axes.x_m[ix], volume.axes.y_m[iy], volume.axes.z_m[iz]);
                    if ((p - kPosition).norm() < kReach_m) continue;
                    most = std::max(most, double{volume.values[volume.index(ix, iy, iz)]});
                }
            }
        }
        return most / top;
    }

    /// Difference to the volume of the whole capture, each with the factor that fits best.
    static double error(const Volume& volume, const Volume& whole) {
        double product = 0.0, square = 0.0, other = 0.0;
        for (std::size_t i = 0; i < whole.values.size(); ++i) {
            const double a = volume.values[i], b = whole.values[i];
            product += a * b;
            square += a * a;
            other += b * b;
        }
        return std::sqrt(std::max(0.0, 1.0 - product * product / (square * other)));
    }

    /// With and without saying what was not observed, each against the same with all points alive.
    static void check(const core::Capture& whole, double tolerance_m) {
        core::Capture gated = whole;
        core::restrict_observed(gated, kGate);
        core::Capture masked = whole;
        mask(masked);
        core::Capture dark = masked;
        dark.observed.reset();

        const Volume alive = run(gated).volume;
        const Reconstruction seen = run(masked);
        EXPECT_LT((nlos_test::brightest_point(seen) - kPosition).norm(), tolerance_m);
        EXPECT_LT(ghosts(seen.volume), ghosts(alive) + kGhosts);
        const double with_mask = error(seen.volume, alive);
        const double without = error(run(dark).volume, run(whole).volume);
        EXPECT_LE(with_mask, std::max(1.02 * without, 0.02));
    }
};

TEST_P(ObservedReconstruction, ShowsTheObjectAndNothingElse) {
    check(whole_capture(), 0.008);
}

TEST_P(ObservedReconstruction, ShowsTheObjectInCountsWithAmbientLight) {
    DetectorSettings detector;
    detector.photons_per_point = 2000.0;
    detector.ambient = 5.0;
    check(detect(whole_capture(), detector), 0.02);
}

TEST_P(ObservedReconstruction, AGateOfAllPointsIsAShorterAxis) {
    const BinRange gate{60, 144};
    core::Capture gated = whole_capture();
    core::restrict_observed(gated, gate);
    core::Capture dark = gated;
    dark.observed.reset();
    core::Capture shorter = dark;
    shorter.time_axis.opl_start_m = shorter.time_axis.bin_begin_m(gate.begin);
    shorter.time_axis.num_bins = gate.size();
    shorter.transient = core::Transient(shorter.scan.num_pairs(), gate.size());
    for (std::size_t pair = 0; pair < shorter.scan.num_pairs(); ++pair) {
        std::ranges::copy(gated.observed_values(pair), shorter.transient.histogram(pair).begin());
    }
    const std::vector<float> found = run(gated).volume.values;
    if (GetParam().first.traits->has_wiener_filter) {  // light cones: they cover all of the axis
        EXPECT_LT(test_support::relative_l2(found, run(dark).volume.values), 0.01);
    } else {
        EXPECT_EQ(found, run(shorter).volume.values);
    }
}

TEST_P(ObservedReconstruction, AnythingObservedGivesFiniteVolumes) {
    core::Capture capture = whole_capture();
    std::vector<BinRange> ranges(capture.scan.num_pairs());
    for (std::size_t pair = 0; pair < ranges.size(); ++pair) {
        const int begin = static_cast<int>(pair % 97);
        ranges[pair] = {begin, begin + static_cast<int>(pair % 41)};
    }
    core::restrict_observed(capture, ranges);
    for (const float value : run(capture).volume.values) ASSERT_TRUE(std::isfinite(value));
    capture = whole_capture();
    std::vector<BinRange> one(capture.scan.num_pairs());
    one[5] = {70, 100};
    core::restrict_observed(capture, one);
    for (const float value : run(capture).volume.values) ASSERT_TRUE(std::isfinite(value));
    core::restrict_observed(capture, {0, 0});
    EXPECT_ERROR_WITH(run(capture), "found no observed bin");
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         ObservedReconstruction,
                         testing::ValuesIn(nlos_test::every_method_and_scan()),
                         [](const auto& mask) { return mask.param.first.name; });

TEST(DeadPoints, TransformsSayThatTheyTakeDeadPointsForDark) {
    core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({16, 16}, {0.05, 0.05}), {0.0, 0.02, 100});
    nlos_test::add_scatterer(capture, kPosition, 4.0);
    std::vector<BinRange> ranges(256, {20, 100});
    core::restrict_observed(capture, ranges);
    const auto says = [&](const nlos_test::MethodCase& method) {
        const auto warnings = reconstruct(capture, method.settings(), {}).warnings;
        return std::ranges::any_of(warnings, [](const std::string& text) {
            return text.starts_with("1 of 256 histograms have bins that were not observed");
        });
    };
    for (const nlos_test::MethodCase& method : nlos_test::every_method()) {
        EXPECT_FALSE(says(method)) << "a gate of all points is only a shorter axis";
    }
    ranges[7] = {0, 0};
    core::restrict_observed(capture, ranges);
    for (const nlos_test::MethodCase& method : nlos_test::every_method()) {
        EXPECT_EQ(says(method), method.traits->needs != nullptr) << method.name;
    }
}

}  // namespace
}  // namespace nlos
