// SPDX-License-Identifier: MIT
// Rays to random points against masks whose error is known.
#include "renderer/third_bounce/visibility_check.h"

#include "tests/support/single_cut.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

namespace {

using core::Vec3;
using renderer::SquaredError;
using renderer::VisibilityCheck;
using renderer::VisibilityMask;
using renderer::WallPoint;
using test_support::kBlackScreen;
using test_support::kTiltedPanel;
using test_support::Parallelogram;

const core::TimeAxis kCheckAxis{1.2, 0.05, 30};
constexpr std::size_t kRaysPerSet = 500;

// A panel, and elements of it that all wall points are taken to see with the same mask.
struct CheckedPanel {
    core::WallScan scan;
    renderer::Scene scene;
    renderer::ElementSet elements;
    renderer::VisibleElements seen;

    CheckedPanel(const core::WallScan& scan_of_pair,
                 const Parallelogram& panel,
                 const std::optional<Parallelogram>& screen,
                 VisibilityMask mask)
        : scan(scan_of_pair),
          scene(geometry(panel, screen), scan, {}),
          elements(test_support::single_cut({scene, scan, kCheckAxis, 0.0}, 0.01)) {
        seen.simd_groups.assign(elements.blocks.size(), renderer::kAllSimdGroups);
        seen.masks.assign(elements.blocks.size() * renderer::ElementBlock::kSize, mask);
    }
    static renderer::SceneGeometry geometry(const Parallelogram& panel,
                                            const std::optional<Parallelogram>& screen) {
        renderer::SceneGeometry result;
        result.objects.push_back(test_support::parallelogram_object(panel));
        if (screen) result.objects.push_back(test_support::parallelogram_object(*screen));
        return result;
    }
    WallPoint wall_point(const core::WallPoints& points) const {
        return {points.positions[0] - elements.origin, points.normals[0]};
    }
    SquaredError check(std::uint64_t sample) const {
        VisibilityCheck check(scene, elements);
        const WallPoint light = wall_point(scan.illumination);
        const WallPoint sensor = wall_point(scan.sensing);
        renderer::VisibilityDifferences found;
        check.add_differences(
            {light, seen}, {sensor, seen}, kCheckAxis, kRaysPerSet, core::Rng(1, 0, sample), found);
        return renderer::squared_error_of(found);
    }
};

struct CheckCase {
    std::string name;
    core::WallScan scan;
    std::optional<double> roughness;
    VisibilityMask mask;
};

class VisibilityCheckOf : public testing::TestWithParam<CheckCase> {};

TEST_P(VisibilityCheckOf, FindsTheSquaredErrorOfMasks) {
    constexpr int kRepeats = 400;
    constexpr int kSteps = 1200;
    Parallelogram panel = kTiltedPanel;
    panel.roughness = GetParam().roughness;
    const CheckedPanel setup(GetParam().scan, panel, kBlackScreen, GetParam().mask);
    const Parallelogram nothing{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    const auto truth = [&](const Parallelogram& screen) {
        return test_support::third_bounce_by_quadrature(
            panel, screen, setup.scan, kCheckAxis, core::kPi, kSteps);
    };
    const std::vector<float> hidden = truth(kBlackScreen);
    const std::vector<float> taken =
        GetParam().mask == 0 ? std::vector<float>(hidden.size()) : truth(nothing);
    double expected = 0.0;
    for (std::size_t bin = 0; bin < hidden.size(); ++bin) {
        expected += std::pow(double{taken[bin]} - double{hidden[bin]}, 2);
    }
    ASSERT_GT(expected, 0.0);
    SquaredError mean;
    double squares = 0.0;
    for (std::uint64_t i = 0; i < kRepeats; ++i) {
        const SquaredError found = setup.check(i);
        mean.value += found.value / kRepeats;
        mean.variance += found.variance / kRepeats;
        squares += found.value * found.value / kRepeats;
    }
    const double variance = squares - mean.value * mean.value;
    const double sigma = std::sqrt(variance / kRepeats);
    EXPECT_LT(sigma, 0.02 * expected);
    EXPECT_GT(
        test_support::normal_tail((mean.value - expected) / std::hypot(sigma, 2e-3 * expected)),
        1e-4)
        << mean.value << " against " << expected;
    // The products of bins know their own spread from above.
    EXPECT_GT(mean.variance, variance);
}

INSTANTIATE_TEST_SUITE_P(
    Pairs,
    VisibilityCheckOf,
    testing::Values(
        CheckCase{"confocal", test_support::confocal_scan({{0.0, 0.0, 0.0}}), {}, 0xffff},
        CheckCase{"hidden", test_support::confocal_scan({{0.0, 0.0, 0.0}}), {}, 0},
        CheckCase{
            "pair", test_support::single_scan({-0.3, 0.1, 0.0}, {{0.1, 0.0, 0.0}}), {}, 0xffff},
        CheckCase{
            "glossy", test_support::single_scan({-0.1, 0.1, 0.0}, {{0.1, 0.0, 0.0}}), 0.5, 0xffff}),
    [](const auto& test) { return test.param.name; });

TEST(VisibilityCheck, FindsNothingWhereMasksAreRight) {
    const CheckedPanel setup(test_support::single_scan({-0.3, 0.1, 0.0}, {{0.1, 0.0, 0.0}}),
                             kTiltedPanel,
                             std::nullopt,
                             renderer::kAllVisible);
    for (std::uint64_t i = 0; i < 20; ++i) {
        const SquaredError found = setup.check(i);
        EXPECT_EQ(found.value, 0.0);
        EXPECT_EQ(found.variance, 0.0);
    }
}

}  // namespace
