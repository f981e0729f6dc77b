// SPDX-License-Identifier: MIT
// The kernel seen through a response: values against convolution, derivatives against differences.
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/random.h"
#include "renderer/triangle/triangle_histogram.h"
#include "tests/support/single_triangle.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace {

using core::TimeAxis;
using renderer::Gradients;
using renderer::TriangleBins;
using renderer::TriangleKnots;

constexpr TimeAxis kAxis{0.9, 0.0096, 60};
constexpr int kTrials = 300;

// Knots in general position, nearly equal in pairs, or nearly equal altogether.
TriangleKnots knots_of_any_spread(core::Rng& rng) {
    const auto spread = [&] { return std::pow(10.0, -7.0 + 6.0 * rng.uniform()); };
    TriangleKnots knots;
    knots.opl_m = {1.1, 1.1 + spread() * (rng.uniform() - 0.5), 1.1 + spread()};
    for (double& weight : knots.weight) weight = rng.uniform();
    return knots;
}

std::vector<double> slot(const TriangleKnots& knots, double sigma_m, std::size_t index) {
    TriangleBins bins;
    renderer::evaluate_triangle(knots, sigma_m, kAxis, Gradients::With, bins);
    std::vector<double> values(static_cast<std::size_t>(kAxis.num_bins));
    for (std::size_t i = 0; i < bins.bins.size(); ++i) {
        values[static_cast<std::size_t>(bins.first_bin) + i] = bins.bins[i].slots[index];
    }
    return values;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum);
}

double norm(const std::vector<double>& a) {
    return distance(a, std::vector<double>(a.size()));
}

// Derivative of the histogram along a change of the knots or the width, by central differences.
template <class Change>
std::vector<double> difference(const Change& change, double step) {
    std::vector<double> gradient = change(step);
    const std::vector<double> below = change(-step);
    for (std::size_t i = 0; i < gradient.size(); ++i)
        gradient[i] = (gradient[i] - below[i]) / (2.0 * step);
    return gradient;
}

TEST(SmearedTriangle, WithoutResponseItIsTheBoxKernel) {
    core::Rng rng(test_support::seed_of("WithoutResponseItIsTheBoxKernel"), 0, 0);
    for (int trial = 0; trial < kTrials; ++trial) {
        const TriangleKnots knots = knots_of_any_spread(rng);
        std::vector<double> expected(static_cast<std::size_t>(kAxis.num_bins));
        test_support::add_triangle(knots, 1.0, kAxis, expected);
        EXPECT_LT(distance(slot(knots, 0.0, 0), expected), 1e-7);
    }
}

TEST(SmearedTriangle, EqualsTheFinelySampledConvolution) {
    core::Rng rng(test_support::seed_of("EqualsTheFinelySampledConvolution"), 0, 0);
    constexpr int kFine = 64;
    constexpr double kSigma_m = 0.012;
    TimeAxis fine = kAxis;
    fine.bin_width_m /= kFine;
    fine.num_bins *= kFine;
    for (int trial = 0; trial < 5; ++trial) {
        TriangleKnots knots =
            knots_of_any_spread(rng);  // wide, so that fine bins are narrow against it
        knots.opl_m = {1.1, 1.13 + 0.02 * rng.uniform(), 1.05 - 0.02 * rng.uniform()};
        std::vector<double> sharp(static_cast<std::size_t>(fine.num_bins));
        test_support::add_triangle(knots, 1.0, fine, sharp);
        std::vector<double> smeared(sharp.size());
        const auto filter =
            core::sample_response(core::GaussianResponse{kSigma_m}, fine.bin_width_m);
        core::apply_filter<double, double>(filter, sharp, smeared);
        std::vector<double> coarse(static_cast<std::size_t>(kAxis.num_bins));
        for (std::size_t i = 0; i < smeared.size(); ++i) coarse[i / kFine] += smeared[i];
        EXPECT_LT(distance(slot(knots, kSigma_m, 0), coarse), 1e-5 * norm(coarse));
    }
}

TEST(SmearedTriangle, KeepsTheWholeWeightForAnyStart) {
    core::Rng rng(test_support::seed_of("KeepsTheWholeWeightForAnyStart"), 0, 0);
    for (int trial = 0; trial < kTrials; ++trial) {
        TriangleKnots knots = knots_of_any_spread(rng);
        const double shift = 0.01 * rng.uniform();
        for (double& opl : knots.opl_m) opl += shift;
        const auto values = slot(knots, 0.004 + 0.008 * rng.uniform(), 0);
        const double mean = (knots.weight[0] + knots.weight[1] + knots.weight[2]) / 3.0;
        EXPECT_NEAR(std::accumulate(values.begin(), values.end(), 0.0), mean, 1e-12);
    }
}

TEST(SmearedTriangle, GradientsMatchFiniteDifferences) {
    core::Rng rng(test_support::seed_of("GradientsMatchFiniteDifferences"), 0, 0);
    for (int trial = 0; trial < kTrials; ++trial) {
        const TriangleKnots knots = knots_of_any_spread(rng);
        const double sigma_m = 0.003 + 0.01 * rng.uniform();
        for (std::size_t j = 0; j < 3; ++j) {
            const auto by_opl = difference(
                [&](double step) {
                    TriangleKnots moved = knots;
                    moved.opl_m[j] += step;
                    return slot(moved, sigma_m, 0);
                },
                1e-4 * sigma_m);
            const auto gradient = slot(knots, sigma_m, 1 + j);
            EXPECT_LT(distance(by_opl, gradient), 1e-6 * norm(gradient));
            const auto by_weight = difference(
                [&](double step) {
                    TriangleKnots moved = knots;
                    moved.weight[j] += step;
                    return slot(moved, sigma_m, 0);
                },
                1e-3);
            EXPECT_LT(distance(by_weight, slot(knots, sigma_m, 4 + j)), 1e-9);
        }
        const auto by_width =
            difference([&](double step) { return slot(knots, sigma_m * std::exp(step), 0); }, 1e-4);
        const auto gradient = slot(knots, sigma_m, 7);
        EXPECT_LT(distance(by_width, gradient), 1e-6 * norm(gradient));
    }
}

TEST(SmearedTriangle, GradientsWithoutResponseMatchFiniteDifferencesBetweenKinks) {
    const TriangleKnots knots{{1.103, 1.1467, 1.2011}, {0.3, 0.9, 0.5}};
    for (std::size_t j = 0; j < 3; ++j) {
        const auto by_opl = difference(
            [&](double step) {
                TriangleKnots moved = knots;
                moved.opl_m[j] += step;
                return slot(moved, 0.0, 0);
            },
            1e-6);
        const auto gradient = slot(knots, 0.0, 1 + j);
        EXPECT_LT(distance(by_opl, gradient), 1e-6 * norm(gradient));
    }
}

}  // namespace
