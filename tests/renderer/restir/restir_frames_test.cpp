// SPDX-License-Identifier: MIT
// Frames that reuse their past against path tracing, and the errors that they report.
#include "renderer/frame_sequence.h"
#include "tests/renderer/restir/restir_fixture.h"
#include "tests/support/repeated_estimates.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace restir_test {
namespace {

using renderer::Estimator;
using test_support::Estimate;
using test_support::expect_same_means;
using test_support::Numbers;
using test_support::repeat;
using test_support::sums_of;

// Totals of every frame, and the last frame's pairs.
Numbers sums_of_frames(const core::Scan& scan,
                       const renderer::SceneDescription& description,
                       bool glossy) {
    const auto scene =
        std::make_shared<const renderer::Scene>(geometry(glossy), scan, description.relay_wall);
    const auto result = renderer::render_frames(
        scene, scan, description, renderer::make_frame_renderer(scan, description.render), {});
    Numbers numbers;
    for (const core::Transient& frame : result.capture.sequence->frames) {
        numbers.push_back(sums_of(frame).back());
    }
    const Numbers last = sums_of(result.capture.transient);
    numbers.insert(numbers.end(), last.begin(), last.end());
    return numbers;
}

class RestirFrames : public testing::TestWithParam<bool> {};

TEST_P(RestirFrames, EveryFrameAgreesWithPathTracing) {
    const bool is_image = GetParam();
    const core::Scan scan = is_image ? close_up() : wall_scan(core::ScanPattern::Confocal);
    for (const auto& [step, frame_s] :
         std::vector<std::pair<double, double>>{{0.02, 0.0}, {0.0, 0.0}, {0.01, 0.1}}) {
        SCOPED_TRACE(testing::Message() << "gate step " << step << ", frame " << frame_s << " s");
        renderer::SceneDescription description;
        description.time_axis = {is_image ? core::TimeAxis{2.45, 0.5, 1} : kGate};
        description.frames = {6, step, frame_s};
        const auto sequence = [&](Estimator method, int samples) {
            description.render = restir_settings(method, samples, is_image ? 3 : 4);
            return repeat(
                [&](std::uint64_t seed) {
                    description.render.seed = seed;
                    return sums_of_frames(scan, description, false);
                },
                std::string("RestirFrames.") + std::string(core::enum_name(method)));
        };
        expect_same_means(sequence(Estimator::Restir, 65), sequence(Estimator::Path, 2048), 0.2);
    }
}

// The mean square that is reported over the mean square of what estimates differ by.
TEST_P(RestirFrames, EveryFrameReportsItsError) {
    constexpr int kSeeds = 48;
    const bool is_image = GetParam();
    const core::Scan scan = is_image ? close_up() : wall_scan(core::ScanPattern::Confocal);
    for (const auto& [step, frame_s] :
         std::vector<std::pair<double, double>>{{0.02, 0.0}, {0.0, 0.0}, {0.01, 0.1}}) {
        renderer::SceneDescription description;
        description.time_axis = {is_image ? core::TimeAxis{2.45, 0.5, 1} : kGate};
        description.frames = {5, step, frame_s};
        description.render = restir_settings(Estimator::Restir, 256, is_image ? 3 : 4);
        const auto scene =
            std::make_shared<const renderer::Scene>(geometry(false), scan, description.relay_wall);
        std::vector<core::FrameSequence> sequences;
        for (int seed = 0; seed < kSeeds; ++seed) {
            description.render.seed = test_support::seed_of("RestirFrames.Errors") + seed;
            sequences.push_back(
                *renderer::render_frames(scene,
                                         scan,
                                         description,
                                         renderer::make_frame_renderer(scan, description.render),
                                         {})
                     .capture.sequence);
        }
        std::vector<double> true_squares;
        for (std::size_t frame = 0; frame < 5; ++frame) {
            const std::size_t size = sequences[0].frames[frame].values().size();
            std::vector<double> sum(size), squares(size);
            double reported = 0.0;
            for (const core::FrameSequence& sequence : sequences) {
                const auto values = sequence.frames[frame].values();
                double norm = 0.0;
                for (std::size_t i = 0; i < size; ++i) {
                    sum[i] += double{values[i]};
                    squares[i] += double{values[i]} * double{values[i]};
                    norm += double{values[i]} * double{values[i]};
                }
                ASSERT_EQ(sequence.errors.size(), 5U);
                reported += std::pow(sequence.errors[frame], 2) * norm / kSeeds;
            }
            double true_square = 0.0;
            for (std::size_t i = 0; i < size; ++i) {
                true_square += (squares[i] - sum[i] * sum[i] / kSeeds) / (kSeeds - 1);
            }
            true_squares.push_back(true_square);
            const double ratio = std::sqrt(true_square / reported);
            EXPECT_GT(ratio, 0.8) << step << ' ' << frame_s << ' ' << frame;
            EXPECT_LT(ratio, 1.25) << step << ' ' << frame_s << ' ' << frame;
        }
        // Five frames are worth five where nothing changes, and elsewhere no less than one.
        EXPECT_LT(true_squares.back(), (step == 0.0 ? 0.35 : 1.5) * true_squares.front());
    }
}

INSTANTIATE_TEST_SUITE_P(Measurements, RestirFrames, testing::Bool(), [](const auto& test) {
    return std::string(test.param ? "image" : "scan");
});

TEST(RestirFramesOfAStillGate, Settle) {
    // With a gate that stands still, what frames have seen adds up: by no more than the settings'
    // defaults, the error falls as that of the mean of the frames does.
    const core::Scan scan = wall_scan(core::ScanPattern::Confocal);
    renderer::SceneDescription description;
    description.time_axis = {kGate};
    description.frames = {20, 0.0, 0.0};
    description.render = restir_settings(Estimator::Restir, 65, 3);
    const Estimate estimate = repeat(
        [&](std::uint64_t seed) {
            description.render.seed = seed;
            return sums_of_frames(scan, description, false);
        },
        "Restir.Static");
    EXPECT_LT(estimate.squared_error[19], 0.12 * estimate.squared_error[0]);
}

}  // namespace
}  // namespace restir_test
