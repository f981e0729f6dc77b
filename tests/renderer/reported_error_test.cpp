// SPDX-License-Identifier: MIT
// Errors that renders state of themselves, and that they are asked to reach.
#include "renderer/bounce_truncation.h"
#include "renderer/core/random.h"
#include "renderer/film/stopping_rule.h"
#include "renderer/frame_sequence.h"
#include "renderer/pass_render.h"
#include "tests/support/error_message.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using core::Vec3;
using renderer::Estimator;

const core::TimeAxis kReportedAxis{1.0, 0.02, 96};

core::WallScan scan_of(int points) {
    std::vector<Vec3> positions;
    for (int i = 0; i < points; ++i) {
        for (int j = 0; j < points; ++j) {
            positions.emplace_back(
                0.8 * (i + 0.5) / points - 0.4, 0.8 * (j + 0.5) / points - 0.4, 0.0);
        }
    }
    return test_support::confocal_scan(positions);
}

renderer::Scene facing_scene(const core::WallScan& scan) {
    return {{test_support::facing_surfaces(), {}}, scan, {}};
}

double squared_norm(const core::Transient& a) {
    double sum = 0.0;
    for (const float value : a.values()) sum += double{value} * double{value};
    return sum;
}

double relative_distance(const core::Transient& a, const core::Transient& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        sum += std::pow(double{a.values()[i]} - double{b.values()[i]}, 2);
    }
    return std::sqrt(sum / squared_norm(b));
}

core::Transient reference_of(const renderer::Scene& scene, const core::WallScan& scan) {
    renderer::RenderSettings settings;
    settings.method = Estimator::ThirdBounce;
    settings.target_error = 2e-3;
    return renderer::render(scene, scan, {kReportedAxis, {}}, settings, {}).capture.transient;
}

TEST(ReportedError, NoiseFromSumsIsThatFromEveryVariance) {
    constexpr int kBins = 5;
    constexpr int kPasses = 6;
    renderer::TransientAccumulator sums(3, kBins, 2, true);
    core::TimeAxis axis{0.0, 1.0, kBins};
    core::Rng rng(7, 0, 0);
    for (int pass = 0; pass < kPasses; ++pass) {
        for (std::size_t pair = 0; pair < 3; ++pair) {
            renderer::PassHistogram histogram({axis, {}}, renderer::GateShape::Box, 2);
            for (int i = 0; i < 4; ++i) {
                histogram.add_to_bin(
                    i % 2, static_cast<int>(rng.uniform() * kBins), 0.0, rng.uniform());
            }
            sums.add_pass(pair, histogram);
        }
    }
    double noise = 0.0;
    core::Transient mean(3, kBins);
    std::optional<core::Transient> variance;
    sums.write(kPasses, 0, mean, variance);
    for (const float value : variance->values()) noise += double{value};
    core::Transient known(3, kBins);
    for (float& value : known.values()) value = 2.0F;
    double all = 0.0;
    for (const float value : mean.values()) all += std::pow(2.0 + double{value}, 2);
    const auto norms = sums.squared_norms(kPasses, &known);
    EXPECT_NEAR(norms.noise, noise, 1e-6 * noise);  // variances are stored as float
    EXPECT_NEAR(norms.signal, all - noise, 1e-6 * all);
}

class SampledEstimator : public testing::TestWithParam<Estimator> {};

// 512 histograms of 96 bins know their own noise to a few percent; the spread of few passes and
// the heavy tails of narrow connections leave a quarter.
TEST_P(SampledEstimator, ReachesItsTargetAndKnowsItsError) {
    constexpr double kTarget = 0.1;
    const core::WallScan scan = scan_of(16);
    const renderer::Scene scene = facing_scene(scan);
    renderer::RenderSettings settings;
    settings.method = GetParam();
    settings.target_error = kTarget;
    const auto result = renderer::render(scene, scan, {kReportedAxis, {}}, settings, {});
    const double error = relative_distance(result.capture.transient, reference_of(scene, scan));
    EXPECT_LT(error, 1.25 * kTarget);
    ASSERT_TRUE(result.estimated_error.has_value());
    EXPECT_LE(*result.estimated_error, kTarget);
    EXPECT_NEAR(*result.estimated_error, error, 0.25 * error);
}

INSTANTIATE_TEST_SUITE_P(ReportedError,
                         SampledEstimator,
                         testing::Values(Estimator::Path,
                                         Estimator::Ellipsoidal,
                                         Estimator::Restir),
                         [](const auto& test) { return std::string(core::enum_name(test.param)); });

// A pass spreads its samples evenly: four times as many leave far less than half of the error,
// which is known all the same. Passes that tell a variance of each bin are short, and lose that.
TEST(ReportedError, LongPassesHaveLessNoise) {
    const core::WallScan scan = scan_of(16);
    const renderer::Scene scene = facing_scene(scan);
    const core::Transient reference = reference_of(scene, scan);
    renderer::RenderSettings settings;
    settings.method = Estimator::Path;
    const auto error_of = [&](int samples, bool variance) {
        settings.samples = samples;
        settings.variance = variance;
        const auto result = renderer::render(scene, scan, {kReportedAxis, {}}, settings, {});
        const double error = relative_distance(result.capture.transient, reference);
        EXPECT_NEAR(*result.estimated_error, error, 0.15 * error);
        return error;
    };
    const double few = error_of(8192, false);
    EXPECT_LT(error_of(32'768, false), 0.4 * few);
    EXPECT_GT(error_of(32'768, true), 0.45 * few);
}

TEST(ReportedError, AutoReachesItWithHigherOrders) {
    constexpr double kTarget = 0.05;
    const core::WallScan scan = scan_of(8);
    const renderer::Scene scene = facing_scene(scan);
    renderer::RenderSettings settings;
    settings.max_bounces = 5;
    settings.target_error = 0.01;
    settings.method = Estimator::Path;
    const auto reference = renderer::render(scene, scan, {kReportedAxis, {}}, settings, {});
    settings.method = Estimator::Auto;
    settings.target_error = kTarget;
    settings.seed = 1;
    const auto result = renderer::render(scene, scan, {kReportedAxis, {}}, settings, {});
    EXPECT_LE(*result.estimated_error, kTarget);
    EXPECT_LT(relative_distance(result.capture.transient, reference.capture.transient),
              std::hypot(1.25 * kTarget, 0.0125));
}

// Higher orders are averaged over the grid: half of the samples suffice, and the error stays what
// it is said to be. The direct return keeps its bin.
TEST(ReportedError, AutoAveragesHigherOrdersOverNeighbours) {
    constexpr double kTarget = 0.01;
    core::WallScan scan = scan_of(16);
    scan.sensing.grid = {16, 16};
    scan.illumination.grid = {16, 16};
    const renderer::Scene scene = facing_scene(scan);
    renderer::RenderSettings settings;
    settings.max_bounces = 5;
    settings.direct_return = true;
    settings.laser_spot_m2 = 1e4;  // as little direct light as of higher orders
    settings.target_error = 0.005;
    settings.by_order = true;
    const core::HistogramAxes axes{{0.0, 0.02, 148}, {}};
    const auto reference = renderer::render(scene, scan, axes, settings, {});
    EXPECT_FALSE(reference.smoothing);
    settings.target_error = kTarget;
    const auto unsmoothed = renderer::render(scene, scan, axes, settings, {});
    settings.by_order = false;
    settings.seed = 1;
    const auto result = renderer::render(scene, scan, axes, settings, {});
    ASSERT_TRUE(result.smoothing);
    EXPECT_GT(result.smoothing->points, 1);
    EXPECT_GT(unsmoothed.samples_per_pair, 2 * result.samples_per_pair);
    EXPECT_LE(*result.estimated_error, kTarget);
    const double error = relative_distance(result.capture.transient, reference.capture.transient);
    EXPECT_LE(error, std::hypot(1.1 * *result.estimated_error, 0.005));
    EXPECT_EQ(result.capture.transient.histogram(7)[0],
              reference.capture.transient.histogram(7)[0]);
    EXPECT_GT(result.capture.transient.histogram(7)[0], 0.0F);
    EXPECT_EQ(result.capture.transient.histogram(7)[1], 0.0F);
}

TEST(ReportedError, OrdersAreLeftOutWhenTheyAreBelowWhatIsAllowed) {
    const core::WallScan scan = scan_of(8);
    const renderer::Scene scene = facing_scene(scan);
    renderer::RenderSettings settings;
    settings.max_bounces = 6;
    settings.by_order = true;
    settings.samples = 20'000;
    settings.method = Estimator::Path;
    // The product of two independent truths has no bias from their noise.
    std::array<core::Capture, 2> truths;
    for (core::Capture& truth : truths) {
        truth = renderer::render(scene, scan, {kReportedAxis, {}}, settings, {}).capture;
        ++settings.seed;
    }
    const auto light_from = [&](std::size_t order) {
        double light = 0.0;
        for (std::size_t k = order; k <= 6; ++k) {
            for (const float value : truths[0].by_order[k - 1].values()) light += value;
        }
        return light;
    };
    const auto tail_from = [&](std::size_t order) {
        double product = 0.0;
        for (std::size_t i = 0; i < truths[0].transient.values().size(); ++i) {
            std::array<double, 2> tails{};
            for (std::size_t k = order; k <= 6; ++k) {
                for (std::size_t t = 0; t < 2; ++t) {
                    tails[t] += double{truths[t].by_order[k - 1].values()[i]};
                }
            }
            product += tails[0] * tails[1];
        }
        return std::sqrt(product);
    };
    for (int order = 6; order > 3; --order) {
        const double fraction = tail_from(static_cast<std::size_t>(order)) / tail_from(1);
        const auto [last, left_out, share] = renderer::find_bounce_truncation(
            {scene, scan, {kReportedAxis, {}}, settings, {}}, 2.5 * fraction);
        EXPECT_LT(last, order) << "fraction " << fraction;
        EXPECT_GE(left_out, 0.95 * fraction);
        EXPECT_LE(left_out, 2.5 * fraction);
        // Both are sums over at least 64,000 samples, known to about 1 %.
        const double light = light_from(static_cast<std::size_t>(last) + 1) / light_from(1);
        EXPECT_NEAR(share, light, 0.05 * light);
    }
    EXPECT_EQ(
        renderer::find_bounce_truncation({scene, scan, {kReportedAxis, {}}, settings, {}}, 0.0)
            .last,
        6);
}

TEST(ReportedError, AutoSaysWhichOrdersItLeavesOut) {
    const core::WallScan scan = scan_of(4);
    // A single plane lights nothing but the wall: there is no order 4 to 6 without the wall.
    const renderer::Scene scene({{test_support::parallelogram_object(
                                     {{-0.1, -0.1, 0.8}, {0.2, 0.0, 0.0}, {0.0, 0.2, 0.0}})},
                                 {}},
                                scan,
                                {});
    renderer::RenderSettings settings;
    settings.max_bounces = 6;
    settings.target_error = 0.002;  // more than soon sampled
    const auto result = renderer::render(scene, scan, {kReportedAxis, {}}, settings, {});
    ASSERT_TRUE(result.left_out);
    EXPECT_EQ(result.left_out->last, 6);
    EXPECT_EQ(result.left_out->share, 0.0);
    EXPECT_GE(*result.estimated_error, result.left_out->error);
    settings.target_error.reset();
    EXPECT_FALSE(renderer::render(scene, scan, {kReportedAxis, {}}, settings, {}).left_out);
}

// Few large facets need few elements: however coarse the target, the error is not 0, and what is
// reported bounds it.
TEST(ReportedError, CoarseTargetsOnLargeFacetsReportAnError) {
    const core::WallScan scan = scan_of(8);
    const renderer::Scene scene(
        {{test_support::parallelogram_object({{-0.2, -0.2, 0.6}, {0.4, 0.05, 0}, {0, 0.4, 0.1}})},
         {}},
        scan,
        {});
    const core::Transient reference = reference_of(scene, scan);
    for (const double target : {0.4, 0.2, 0.1, 0.05, 0.02}) {
        renderer::RenderSettings settings;
        settings.method = Estimator::ThirdBounce;
        settings.target_error = target;
        const auto result = renderer::render(scene, scan, {kReportedAxis, {}}, settings, {});
        const double error = relative_distance(result.capture.transient, reference);
        EXPECT_LE(error, target);
        EXPECT_LE(error, *result.estimated_error + 2e-3) << target;
        EXPECT_GT(*result.estimated_error, 0.0) << target;
    }
}

TEST(ReportedError, RestirReportsOneForFewSamples) {
    const core::WallScan scan = scan_of(6);
    const renderer::Scene scene = facing_scene(scan);
    const core::TimeAxis gate{1.5, 0.3, 1};
    renderer::RenderSettings settings;
    settings.method = Estimator::Restir;
    const auto render = [&](int samples) {
        settings.samples = samples;
        return renderer::render(scene, scan, {gate, {}}, settings, {});
    };
    EXPECT_FALSE(render(1).estimated_error);
    for (const int samples : {2, 32, 256}) {
        const auto result = render(samples);
        ASSERT_TRUE(result.estimated_error) << samples;
        EXPECT_GT(*result.estimated_error, 0.0) << samples;
        EXPECT_LE(result.samples_per_pair, static_cast<std::uint64_t>(samples) + 1) << samples;
    }
}

// More passes would not help.
TEST(ReportedError, AnErrorThatIsKnownToBeLargerDoesNotKeepPassesGoing) {
    renderer::RenderSettings settings;
    settings.target_error = 0.1;
    const core::TimeAxis axis{0.0, 1.0, 1};
    for (const double known_error : {4.0, std::numeric_limits<double>::infinity()}) {
        renderer::TransientAccumulator sums(1, 1, 1, false);
        renderer::StoppingRule rule(settings, 1, {nullptr, known_error, 0.0});
        double fraction = 0.0;
        for (int pass = 1; pass <= 64 && fraction < 1.0; ++pass) {
            renderer::PassHistogram histogram({axis, {}}, renderer::GateShape::Box, 1);
            histogram.add_to_bin(0, 0, 0.0, pass % 2 == 0 ? 1.1 : 0.9);
            sums.add_pass(0, histogram);
            fraction = rule.fraction_done(pass, 0.0, sums);
        }
        EXPECT_EQ(fraction, 1.0) << known_error;
    }
}

TEST(ReportedError, FramesThatShareTheirPastRefuseOne) {
    const core::WallScan scan = scan_of(2);
    renderer::RenderSettings settings;
    settings.method = Estimator::Restir;
    settings.target_error = 0.1;
    EXPECT_ERROR_WITH(renderer::make_frame_renderer(scan, settings), "render.target_error");
}

}  // namespace
