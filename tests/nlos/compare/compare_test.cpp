// SPDX-License-Identifier: MIT
#include "nlos/compare/compare.h"

#include "nlos/compare/compare_image.h"
#include "renderer/core/nearest_neighbours.h"
#include "renderer/core/random.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/example_volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using test_support::column_volume;
using test_support::truth_of;

using test_support::kBackground;

std::vector<core::Vec3> random_points(std::size_t count, std::uint64_t seed) {
    core::Rng rng(seed, 0, 0);
    std::vector<core::Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        const double x = rng.uniform();
        const double y = rng.uniform();
        points.emplace_back(x, y, rng.uniform());
    }
    return points;
}

/// Every score of `metrics` by name, those without a value left out.
std::vector<std::string> scored_names(Metrics metrics) {
    std::vector<std::string> names;
    for_each_field(metrics, [&](const char* name, const auto& field, const char*) {
        if (!field) return;
        EXPECT_TRUE(std::isfinite(static_cast<double>(*field))) << name;
        names.emplace_back(name);
    });
    return names;
}

TEST(Compare, DepthErrorsAreThoseOfTheCommonColumns) {
    // Errors +1, -2 and +6 mm; columns 3 and 5 have no reconstructed depth, however bright, column
    // 4 is background in truth.
    const Reconstruction result =
        column_volume({1.0F, 0.9F, 0.1F, 0.19F, 0.8F, 0.7F},
                      {0.701, 0.698, 0.706, kBackground, 0.9, kBackground});
    const core::DepthMap truth = truth_of(result, {0.7, 0.7, 0.7, 0.7, kBackground, 0.7});
    const Metrics metrics = compare_to_truth(result, truth);
    EXPECT_NEAR(metrics.depth_mae_m.value(), 3e-3, 1e-12);
    EXPECT_NEAR(metrics.depth_median_m.value(), 2e-3, 1e-12);
    EXPECT_NEAR(metrics.depth_rmse_m.value(), std::sqrt(41e-6 / 3.0), 1e-12);
    EXPECT_DOUBLE_EQ(metrics.depth_coverage.value(), 3.0 / 5.0);
    EXPECT_DOUBLE_EQ(metrics.mask_iou_stated.value(), 3.0 / 6.0);
}

TEST(Compare, MedianOfAnEvenNumberOfErrorsIsTheMiddle) {
    const Reconstruction result = column_volume({1.0F, 1.0F}, {0.701, 0.704});
    const Metrics metrics = compare_to_truth(result, truth_of(result, {0.7, 0.7}));
    EXPECT_NEAR(metrics.depth_median_m.value(), 2.5e-3, 1e-12);
}

TEST(Compare, MaskIouCountsColumnsAboveAFifthOfTheMaximum) {
    // Reconstructed mask: columns 0, 1, 2; true mask: 1, 2, 3, 4; a value at the threshold is out.
    const Reconstruction result = column_volume({5.0F, 2.5F, 1.25F, 1.0F, 0.75F, 0.25F}, {});
    const core::DepthMap truth = truth_of(result, {kBackground, 0.7, 0.7, 0.7, 0.7, kBackground});
    const Metrics metrics = compare_to_truth(result, truth);
    EXPECT_DOUBLE_EQ(metrics.mask_iou.value(), 2.0 / 5.0);
    // Best: between 0.75 and 0.25, where five columns are in and four of them rightly.
    EXPECT_DOUBLE_EQ(metrics.mask_iou_best.value(), 4.0 / 5.0);
    EXPECT_DOUBLE_EQ(metrics.mask_iou_best_threshold.value(), 0.75 / 5.0);
}

TEST(Compare, BestMaskIouIsTheBestOfAllThresholds) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        core::Rng rng(seed, 1, 0);
        std::vector<float> image(60);
        Covered truth(image.size());
        for (std::size_t i = 0; i < image.size(); ++i) {
            truth[i] = rng.uniform() < 0.3 ? std::ceil(4.0 * rng.uniform()) / 4.0 : 0.0;
            // Few levels, so that many values tie.
            image[i] = static_cast<float>(std::floor(8.0 * rng.uniform() + 3.0 * truth[i]));
        }
        double best = 0.0;
        for (double threshold = -0.5; threshold < 11.0; threshold += 1.0) {
            double right = 0.0;
            double either = 0.0;
            for (std::size_t i = 0; i < image.size(); ++i) {
                const bool found = static_cast<double>(image[i]) > threshold;
                right += found && truth[i] > 0.0;
                either += found ? 1.0 : truth[i];
            }
            best = std::max(best, right / either);
        }
        const ThresholdedMask exact = best_mask(image, truth).value();
        EXPECT_DOUBLE_EQ(exact.iou, best);
        // Just below its fraction of the maximum lies the threshold that gives it.
        EXPECT_DOUBLE_EQ(
            mask_iou(mask_above_fraction(image, exact.fraction * (1.0 - 1e-6)), truth).value(),
            best);
        EXPECT_GE(exact.iou, mask_iou(mask_above_fraction(image, 0.2), truth).value_or(0.0));
    }
}

TEST(Compare, NearestNeighboursAreThoseOfABruteForceSearch) {
    const auto queries = random_points(300, 1);
    const auto points = random_points(500, 2);
    const core::NearestNeighbours found = core::nearest_neighbours(queries, points);
    ASSERT_EQ(found.distances_m.size(), queries.size());
    for (std::size_t i = 0; i < queries.size(); ++i) {
        double nearest = INFINITY;
        for (const core::Vec3& point : points) {
            nearest = std::min(nearest, (point - queries[i]).norm());
        }
        EXPECT_NEAR(found.distances_m[i], nearest, 1e-14);
        EXPECT_NEAR((points[found.indices[i]] - queries[i]).norm(), nearest, 1e-14);
    }
}

TEST(Compare, ChamferAndFScoreMatchTheHandComputedValues) {
    const core::PointCloud result{{{0.0, 0.0, 0.0}, {0.3, 0.0, 0.0}}, {}};
    const core::PointCloud truth{{{0.0, 0.0, 0.1}}, {}};
    const Metrics metrics = compare_points(result, truth, 0.2);
    const double far = std::hypot(0.3, 0.1);
    EXPECT_NEAR(metrics.chamfer_m.value(), 0.5 * ((0.1 + far) / 2.0 + 0.1), 1e-15);
    EXPECT_DOUBLE_EQ(metrics.accuracy.value(), 0.5);
    EXPECT_DOUBLE_EQ(metrics.completeness.value(), 1.0);
    EXPECT_NEAR(metrics.fscore.value(), 2.0 / 3.0, 1e-15);
    EXPECT_DOUBLE_EQ(metrics.fscore_threshold_m.value(), 0.2);
    EXPECT_EQ(compare_points(result, truth, 0.05).fscore.value(), 0.0);
    EXPECT_FALSE(metrics.normal_mae_deg);
}

TEST(Compare, NormalsOfPointsAreComparedAtNearestNeighbours) {
    const double tilt = 30.0 * core::kPi / 180.0;
    const core::Vec3 tilted(std::sin(tilt), 0.0, -std::cos(tilt));
    const core::Vec3 straight(0.0, 0.0, -1.0);
    const core::PointCloud result{{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, {straight, straight}};
    const core::PointCloud truth{{{1.0, 0.0, 0.1}, {0.0, 0.0, 0.1}}, {tilted, straight}};
    EXPECT_NEAR(compare_points(result, truth, 0.2).normal_mae_deg.value(), 15.0, 1e-9);
    const core::PointCloud turned{truth.positions, {-tilted, -straight}};
    EXPECT_NEAR(compare_points(result, turned, 0.2).normal_mae_deg.value(), 15.0, 1e-9);
}

TEST(Compare, NormalsOfColumnsAreTurnedIntoTheWorld) {
    Reconstruction result = column_volume({1.0F, 1.0F}, {0.7, 0.7});
    const Eigen::AngleAxisd turn(0.7, core::Vec3::UnitY());
    result.volume.axes.world_from_wall = core::Transform(turn);
    result.volume.normals.assign(2, Eigen::Vector3f(0.0F, 0.0F, -1.0F));
    core::DepthMap truth = truth_of(result, {0.7, 0.7});
    const Eigen::AngleAxisd tilt(10.0 * core::kPi / 180.0, core::Vec3::UnitX());
    truth.normals = {turn * core::Vec3(0.0, 0.0, -1.0), turn * (tilt * core::Vec3(0.0, 0.0, -1.0))};
    EXPECT_NEAR(compare_to_truth(result, truth).normal_mae_deg.value(), 5.0, 1e-5);
}

TEST(Compare, PsnrMatchesTheHandComputedValue) {
    // Projection / maximum: 1, 0.5, 0; truth: albedo / maximum: 1, 1, 0. MSE = 0.25 / 3.
    const Reconstruction result = column_volume({4.0F, 2.0F, 0.0F}, {});
    core::DepthMap truth = truth_of(result, {0.7, 0.7, kBackground});
    truth.albedo = {0.5, 0.5, 0.9};
    const Metrics metrics = compare_to_truth(result, truth);
    EXPECT_NEAR(metrics.psnr_db.value(), 10.0 * std::log10(12.0), 1e-6);
    EXPECT_FALSE(metrics.ssim);  // too small for a window
}

TEST(Compare, SsimOfConstantImagesIsTheirLuminanceTerm) {
    const std::vector<double> a(12 * 13, 0.5);
    const std::vector<double> b(12 * 13, 0.25);
    const double expected = (2.0 * 0.5 * 0.25 + 1e-4) / (0.25 + 0.0625 + 1e-4);
    EXPECT_NEAR(ssim(a, b, 12, 13).value(), expected, 1e-12);
    EXPECT_NEAR(ssim(a, a, 12, 13).value(), 1.0, 1e-12);
}

TEST(Compare, SsimMatchesAnIndependentImplementation) {
    std::vector<double> a;
    std::vector<double> b;
    for (int i = 0; i < 16; ++i) {
        for (int j = 0; j < 14; ++j) {
            a.push_back(0.5 + 0.5 * std::sin(0.3 * i + 0.1 * j));
            b.push_back(0.5 + 0.4 * std::cos(0.2 * i - 0.25 * j));
        }
    }
    // From a direct two-dimensional sum over windows in NumPy.
    EXPECT_NEAR(ssim(a, b, 16, 14).value(), -0.03158339927310015, 1e-12);
}

TEST(Compare, PeakDistanceIsThatOfTheBrightestVoxel) {
    const Reconstruction result = column_volume({0.5F, 3.0F, 1.0F}, {});
    const core::DepthMap truth = truth_of(result, {kBackground, kBackground, 0.72});
    const double dx = result.volume.axes.x_m[2] - result.volume.axes.x_m[1];
    EXPECT_NEAR(compare_to_truth(result, truth).peak_distance_m.value(),
                std::hypot(dx, 0.72 - test_support::kVoxelDepth_m),
                1e-12);
}

TEST(Compare, MatchesAreWithinAVoxelDiagonal) {
    const Reconstruction result = column_volume({1.0F, 1.0F}, {0.7, 0.7});
    const Metrics metrics = compare_to_truth(result, truth_of(result, {0.7, 0.7}));
    const auto& axes = result.volume.axes;
    EXPECT_NEAR(metrics.fscore_threshold_m.value(),
                std::hypot(axes.x_m[1] - axes.x_m[0], axes.z_m[1] - axes.z_m[0]),
                1e-12);
    EXPECT_DOUBLE_EQ(metrics.fscore.value(), 1.0);
    EXPECT_DOUBLE_EQ(
        compare_to_truth(result, truth_of(result, {0.7, 0.7}), 0.1).fscore_threshold_m.value(), 0.1)
        << "unless one is given";
}

TEST(Compare, MissingDataGivesNoScoreAndNeverNan) {
    const Reconstruction bright = column_volume({1.0F, 0.5F, 0.0F}, {0.7, 0.7, kBackground});
    const Reconstruction dark = column_volume({0.0F, 0.0F, 0.0F}, {});
    const core::DepthMap object = truth_of(bright, {0.7, kBackground, kBackground});
    const core::DepthMap nothing = truth_of(bright, {kBackground, kBackground, kBackground});
    EXPECT_TRUE(scored_names(compare_to_truth(dark, object)).empty());
    EXPECT_TRUE(scored_names(compare_to_truth(bright, nothing)).empty());
    EXPECT_TRUE(scored_names(compare_to_truth(dark, nothing)).empty());
    EXPECT_TRUE(scored_names(compare_points({}, {{core::Vec3::Zero()}, {}}, 0.1)).empty());
    EXPECT_TRUE(scored_names(compare_points({{core::Vec3::Zero()}, {}}, {}, 0.1)).empty());
    EXPECT_TRUE(scored_names(compare_volumes(dark, dark)).empty());
    EXPECT_FALSE(scored_names(compare_to_truth(bright, object)).empty());
}

TEST(Compare, TruthOnOtherColumnsIsRefused) {
    const Reconstruction result = column_volume({1.0F, 0.5F}, {0.7, 0.7});
    EXPECT_ERROR_WITH(compare_to_truth(result, core::DepthMap({0.0}, {0.0})), "compare: x");
    core::DepthMap shifted = truth_of(result, {0.7, 0.7});
    shifted.x_m[1] += 0.01;
    EXPECT_ERROR_WITH(compare_to_truth(result, shifted), "must have the same grid");
    core::DepthMap elsewhere = truth_of(result, {0.7, 0.7});
    elsewhere.world_from_wall.translate(core::Vec3(0.1, 0.0, 0.0));
    EXPECT_ERROR_WITH(compare_to_truth(result, elsewhere), "wall");
}

TEST(Compare, AVolumeEqualsItself) {
    Reconstruction volume = column_volume({1.0F, 0.5F, 0.0F}, {0.7, 0.71, kBackground});
    volume.seconds = 2.5;
    volume.peak_bytes = 1000;
    const Metrics metrics = compare_volumes(volume, volume);
    EXPECT_EQ(metrics.depth_mae_m.value(), 0.0);
    EXPECT_EQ(metrics.mask_iou.value(), 1.0);
    EXPECT_EQ(metrics.mask_iou_best.value(), 1.0);
    EXPECT_EQ(metrics.chamfer_m.value(), 0.0);
    EXPECT_EQ(metrics.peak_distance_m.value(), 0.0);
    EXPECT_EQ(metrics.rel_l2.value(), 0.0);
    EXPECT_FALSE(metrics.psnr_db);  // infinite
    EXPECT_EQ(metrics.seconds.value(), 2.5);
    EXPECT_EQ(metrics.peak_rss_bytes.value(), 1000U);
}

TEST(Compare, VolumesOnOtherGridsAreRefused) {
    const Reconstruction a = column_volume({1.0F, 0.5F}, {});
    Reconstruction b = a;
    b.volume.axes.z_m[1] += 0.01;
    EXPECT_ERROR_WITH(compare_volumes(b, a), "compare: z");
}

TEST(Compare, CapturesDifferByTheirRelativeNorm) {
    core::Capture reference = test_support::example_capture(core::ScanPattern::Confocal);
    core::Capture result = reference;
    for (float& value : result.transient.values()) value *= 1.25F;
    const Metrics metrics = compare_captures(result, reference);
    EXPECT_NEAR(metrics.rel_l2.value(), 0.25, 1e-7);
    EXPECT_NEAR(metrics.rel_mse.value(), 0.0625, 1e-7);
    EXPECT_EQ(scored_names(metrics).size(), 2U);

    for (float& value : reference.transient.values()) value = 0.0F;
    EXPECT_TRUE(scored_names(compare_captures(result, reference)).empty());
}

TEST(Compare, OnlyBinsCountThatBothCapturesObserved) {
    const core::Capture whole = test_support::example_capture(core::ScanPattern::Confocal);
    core::Capture reference = whole;
    core::Capture result = whole;
    for (float& value : result.transient.values()) value *= 1.25F;
    core::restrict_observed(reference, {1, 5});
    core::restrict_observed(result, {{0, 0}, {0, 4}, {0, 5}, {0, 5}, {2, 3}, {0, 5}});
    EXPECT_NEAR(compare_captures(result, reference).rel_l2.value(), 0.25, 1e-7);
    EXPECT_NEAR(compare_captures(result, whole).rel_l2.value(), 0.25, 1e-7);
    EXPECT_NEAR(compare_captures(whole, result).rel_l2.value(), 0.2, 1e-7);
    ASSERT_EQ(comparison_warnings(result, reference).size(), 1U);
    EXPECT_NE(comparison_warnings(result, reference)[0].find("did not observe"), std::string::npos);
    core::restrict_observed(result, {0, 1});
    EXPECT_FALSE(compare_captures(result, reference).rel_l2) << "nothing in common";
}

TEST(Compare, OrderOfWallPointsDoesNotMatter) {
    for (const auto pattern : {core::ScanPattern::Confocal, core::ScanPattern::Exhaustive}) {
        const core::Capture reference = test_support::example_capture(pattern);
        core::Capture turned = reference;
        std::ranges::reverse(turned.scan.wall().sensing.positions);
        std::ranges::reverse(turned.scan.wall().illumination.positions);
        // With both lists reversed, pairs run backwards, too.
        const std::size_t last = turned.transient.num_pairs() - 1;
        for (std::size_t pair = 0; pair <= last; ++pair) {
            std::ranges::copy(reference.transient.histogram(pair),
                              turned.transient.histogram(last - pair).begin());
        }
        EXPECT_EQ(compare_captures(turned, reference).rel_l2.value(), 0.0);
        core::Capture gated = turned;
        std::vector<core::BinRange> ranges(last + 1, {0, 5});
        ranges[1] = {2, 3};
        core::restrict_observed(gated, ranges);
        EXPECT_EQ(compare_captures(gated, reference).rel_l2.value(), 0.0);
        for (core::Vec3& point : turned.scan.wall().sensing.positions) point.x() += 0.01;
        EXPECT_GT(compare_captures(turned, reference).rel_l2.value(), 0.0);
    }
}

TEST(Compare, CapturesOfDifferentScansAreNamed) {
    const core::Capture reference = test_support::example_capture(core::ScanPattern::Confocal);
    EXPECT_TRUE(comparison_warnings(reference, reference).empty());
    core::Capture other = reference;
    for (core::Vec3& point : other.scan.wall().sensing.positions) point.x() += 0.03;
    const auto moved = comparison_warnings(other, reference);
    ASSERT_FALSE(moved.empty());
    EXPECT_NE(moved[0].find("up to 0.03 m"), std::string::npos) << moved[0];
    other = reference;
    other.scan.wall().pattern = core::ScanPattern::Single;
    ASSERT_EQ(comparison_warnings(other, reference).size(), 1U);
    EXPECT_NE(comparison_warnings(other, reference)[0].find("single against confocal"),
              std::string::npos);
    other = reference;
    for (float& value : other.transient.values()) value = 0.0F;
    EXPECT_EQ(comparison_warnings(other, reference),
              std::vector<std::string>{"the result holds no light"});
}

TEST(Compare, CapturesThatDoNotMatchAreRefused) {
    const core::Capture reference = test_support::example_capture(core::ScanPattern::Confocal);
    EXPECT_ERROR_WITH(
        compare_captures(test_support::example_capture(core::ScanPattern::Exhaustive), reference),
        "must have the same shape");
    core::Capture late = reference;
    late.time_axis.opl_start_m += 0.1 * late.time_axis.bin_width_m;
    EXPECT_ERROR_WITH(compare_captures(late, reference), "must have the same bins");
    core::Capture counts = reference;
    counts.unit = core::TransientUnit::Counts;
    EXPECT_ERROR_WITH(compare_captures(counts, reference), "found counts against radiance");
}

}  // namespace
}  // namespace nlos
