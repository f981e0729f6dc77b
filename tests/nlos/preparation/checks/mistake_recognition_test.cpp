// SPDX-License-Identifier: MIT
// Mistakes in describing captures of a few scatterers; those of rendered scenes are in
// tests/apps/mistakes_test.cpp.
#include "nlos/preparation/checks/capture_correction.h"
#include "nlos/preparation/checks/scatter_fit.h"
#include "nlos/preparation/histogram_sample.h"
#include "renderer/core/system/parallel.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

using core::Vec3;
using nlos_test::wall_grid;

/// A bent bar before the wall.
void add_bar(core::Capture& capture) {
    for (int i = 0; i <= 20; ++i) {
        const double t = 0.1 * i - 1.0;
        nlos_test::add_scatterer(capture, Vec3(0.2 * t, 0.05 + 0.1 * t, 0.6 + 0.1 * t * t), 4.0);
    }
}

core::Capture bar_capture(const core::WallPoints& points) {
    core::Capture capture = nlos_test::confocal_capture(points, {0.0, 0.012, 250});
    add_bar(capture);
    return capture;
}

std::vector<double> dark(const core::Capture& capture) {
    return std::vector<double>(capture.scan.num_pairs(), 0.0);
}

HistogramSample sample_of(const core::Capture& capture) {
    return *sample_histograms(capture, dark(capture), std::nullopt);
}

double fraction(const core::Capture& capture, const CaptureCorrection& correction) {
    const HistogramSample sample = sample_of(capture);
    return unexplained_fraction(sample, corrected_geometry(capture, sample, correction));
}

TEST(ScatterFit, ExplainsAllButWhatIsMisdescribed) {
    const core::Capture capture = bar_capture(wall_grid({16, 16}, {0.06, 0.06}));
    const double right = fraction(capture, {});
    EXPECT_LT(right, 0.2);
    EXPECT_GT(fraction(capture, {.length_factor = 2.0}), 3.0 * right);
    EXPECT_GT(fraction(capture, {.length_factor = 0.5}), 3.0 * right);
    EXPECT_GT(fraction(capture, {.shift_m = 1.0}), 3.0 * right);
    EXPECT_GT(fraction(capture, {.flip_t = true}), 3.0 * right);
}

TEST(ScatterFit, DoesNotDependOnHowBrightPixelsAre) {
    core::Capture capture = bar_capture(wall_grid({12, 12}, {0.08, 0.08}));
    const double even = fraction(capture, {});
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        for (float& value : capture.transient.histogram(pair)) {
            value *= 1.0F + static_cast<float>(pair % 5);
        }
    }
    EXPECT_NEAR(fraction(capture, {}), even, 0.05);
}

TEST(ScatterFit, HasTheSameBitsForAnyNumberOfThreads) {
    const core::Capture capture = bar_capture(wall_grid({12, 12}, {0.08, 0.08}));
    const auto with = [&](int threads) {
        const core::ThreadLimit limit(threads);
        return fraction(capture, {});
    };
    EXPECT_EQ(with(1), with(7));
}

TEST(CaptureCorrection, WallAndLengthsAreOneButForSize) {
    const core::Capture capture = bar_capture(wall_grid({12, 12}, {0.08, 0.08}));
    EXPECT_TRUE(is_scale_free(capture.scan.wall()));
    EXPECT_NEAR(
        fraction(capture, {.length_factor = 0.5}), fraction(capture, {.wall_factor = 2.0}), 1e-3);
}

TEST(CaptureCorrection, FlipsOfConfocalGridsAreMirrorImages) {
    const core::Capture capture = bar_capture(wall_grid({16, 12}, {0.05, 0.07}));
    const HistogramSample sample = sample_of(capture);
    EXPECT_TRUE(is_mirror_image(capture, sample, {.flip_x = true}));
    EXPECT_TRUE(is_mirror_image(capture, sample, {.flip_y = true}));
    EXPECT_FALSE(is_mirror_image(capture, sample, {.swap_xy = true}));
    const core::Capture square = bar_capture(wall_grid({12, 12}, {0.07, 0.07}));
    EXPECT_TRUE(is_mirror_image(square, sample_of(square), {.swap_xy = true}));
}

TEST(CaptureCorrection, FlipsAgainstASpotOffTheMiddleAreNone) {
    core::Capture capture = bar_capture(wall_grid({12, 12}, {0.07, 0.07}));
    capture.scan.wall().pattern = core::ScanPattern::Single;
    capture.scan.wall().illumination = wall_grid({1, 1}, {0.0, 0.0});
    EXPECT_TRUE(is_mirror_image(capture, sample_of(capture), {.flip_x = true}));
    capture.scan.wall().illumination.positions[0] = Vec3(0.2, 0.0, 0.0);
    EXPECT_FALSE(is_mirror_image(capture, sample_of(capture), {.flip_x = true}));
    EXPECT_TRUE(is_mirror_image(capture, sample_of(capture), {.flip_y = true}));
}

TEST(CaptureCorrection, FarFactorsAreListedOnlyForRangesOutOfProportion) {
    core::Capture capture = bar_capture(wall_grid({12, 12}, {0.08, 0.08}));
    const auto has_far_factor = [&] {
        return std::ranges::any_of(possible_corrections(capture, sample_of(capture)),
                                   [](const auto& c) { return c.length_factor == 1e-3; });
    };
    EXPECT_FALSE(has_far_factor());
    capture.time_axis.bin_width_m *= 1e3;
    EXPECT_TRUE(has_far_factor());
}

TEST(MistakeText, NamesTheOptionThatMends) {
    core::Capture capture = bar_capture(wall_grid({16, 16}, {0.06, 0.06}));
    capture.time_axis.bin_width_m = 12.0;
    EXPECT_EQ(describe_mistake(capture, {.length_factor = 1e-3}),
              "lengths look 1000 times too long, as if ps had been taken for ns: --set "
              "capture.bin_width_m=0.012; or the wall looks 1000 times too small, as if km had "
              "been taken for metres: --set "
              "capture.wall_size_m=[900,900]");
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    capture.time_axis = {1.5, 0.024, 250};
    EXPECT_EQ(describe_mistake(capture, {.length_factor = 0.5}),
              "lengths look 2 times too long, as if round trips had been doubled once more: --set "
              "capture.bin_width_m=0.012 capture.opl_shift_m=-0.75");
    EXPECT_EQ(describe_mistake(capture, {.wall_factor = 2.0}),
              "the wall looks 2 times too small, as if half its width had been taken for the "
              "width: --set capture.wall_size_m=[1.8,1.8]");
    EXPECT_EQ(describe_mistake(capture, {.shift_m = -1.3}),
              "time zero looks about 1.3 m too early: --set capture.opl_shift_m=-1.3");
}

TEST(DirectReturn, IsFoundWithItsOffset) {
    core::Capture capture = bar_capture(wall_grid({16, 16}, {0.06, 0.06}));
    EXPECT_FALSE(find_direct_return(capture, dark(capture)));
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        capture.transient.histogram(pair)[0] = 1e5F;
    }
    capture.time_axis.opl_start_m = 0.994;
    const auto direct = find_direct_return(capture, dark(capture));
    ASSERT_TRUE(direct);
    EXPECT_NEAR(direct->offset_m, 1.0, 1e-9);
    EXPECT_EQ(direct->end_bins, std::vector<std::size_t>(196, 1));
}

TEST(MistakeEvidence, IsNothingForFewPairsForDarknessAndForLikeHistograms) {
    const core::Capture few = bar_capture(wall_grid({2, 4}, {0.2, 0.2}));
    EXPECT_FALSE(mistake_evidence(few, dark(few)));
    core::Capture capture = bar_capture(wall_grid({12, 12}, {0.08, 0.08}));
    for (std::size_t pair = 1; pair < capture.scan.num_pairs(); ++pair) {
        std::ranges::copy(capture.transient.histogram(0),
                          capture.transient.histogram(pair).begin());
    }
    EXPECT_FALSE(mistake_evidence(capture, dark(capture)));
    std::ranges::fill(capture.transient.values(), 0.0F);
    EXPECT_FALSE(mistake_evidence(capture, dark(capture)));
}

TEST(MistakeEvidence, OfHugeAndTinyNumbersIsFinite) {
    for (const double factor : {1e-300, 1e-30, 1e30, 1e300}) {
        core::Capture capture = bar_capture(wall_grid({12, 12}, {0.08, 0.08}));
        capture.time_axis.bin_width_m *= factor;
        const auto evidence = mistake_evidence(capture, dark(capture));
        ASSERT_TRUE(evidence);
        EXPECT_TRUE(std::isfinite(evidence->given));
        for (const auto& tried : evidence->corrections) {
            EXPECT_TRUE(std::isfinite(tried.unexplained));
        }
    }
}

}  // namespace
}  // namespace nlos
