// SPDX-License-Identifier: MIT
#include "nlos/solver/confocal_problem.h"

#include "nlos/preparation/wall_frame.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nlos {
namespace {

constexpr std::size_t kProblemSide = 16;

core::Capture empty_capture() {
    return nlos_test::confocal_capture(
        nlos_test::wall_grid({kProblemSide, kProblemSide}, {0.05, 0.05}), {0.8, 0.02, 40});
}

ConfocalProblem problem_of(const core::Capture& capture, bool is_counts) {
    const WallFrame wall = derive_wall_frame(capture.scan.wall());
    const core::Progress progress;
    const VolumeAxes axes{std::vector<double>(kProblemSide),
                          std::vector<double>(kProblemSide),
                          {0.6},
                          wall.world_from_wall};
    MethodInput input{capture.scan.wall(),
                      capture.time_axis,
                      capture.transient,
                      wall,
                      axes,
                      {0.4, 0.8},
                      progress};
    input.measurement.is_counts = is_counts;
    return make_confocal_problem(input, {}, false);
}

double range_of(const ConfocalProblem& problem, int bin) {
    return 0.5 * problem.axis.bin_center_m(bin);
}

// Noise that falls off with range as the light does.
TEST(ConfocalProblem, PrecisionOfRadianceIsOneOverItsVariance) {
    core::Capture capture = empty_capture();
    std::mt19937 generator(1);
    std::normal_distribution<double> normal;
    const auto noise_at = [](double range) { return 0.01 * std::pow(range, -4.0); };
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        auto histogram = capture.transient.histogram(pair);
        for (std::size_t i = 0; i < histogram.size(); ++i) {
            const double range = 0.5 * capture.time_axis.bin_center_m(static_cast<double>(i));
            histogram[i] = static_cast<float>(1.0 + noise_at(range) * normal(generator));
        }
    }
    const ConfocalProblem problem = problem_of(capture, false);
    ASSERT_EQ(problem.likelihood, Likelihood::Gaussian);
    for (int bin = 0; bin < problem.axis.num_bins; ++bin) {
        const double variance = std::pow(noise_at(range_of(problem, bin)), 2);
        EXPECT_NEAR(problem.precision[static_cast<std::size_t>(bin)] * variance, 1.0, 0.1) << bin;
    }
}

// Of counts of mean 50, weighted by themselves: 51.
TEST(ConfocalProblem, PrecisionOfCountsIsOneOverTheirMean) {
    core::Capture capture = empty_capture();
    std::mt19937 generator(2);
    std::poisson_distribution<int> counts(50.0);
    for (float& value : capture.transient.values()) value = static_cast<float>(counts(generator));
    const ConfocalProblem problem = problem_of(capture, true);
    ASSERT_EQ(problem.likelihood, Likelihood::Poisson);
    for (const double precision : problem.precision) EXPECT_NEAR(51.0 * precision, 1.0, 0.1);
}

}  // namespace
}  // namespace nlos
