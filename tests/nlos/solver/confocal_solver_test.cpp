// SPDX-License-Identifier: MIT
#include "nlos/solver/confocal_solver.h"

#include "nlos/reconstruct.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nlos {
namespace {

using core::Vec3;

/// A flat square plate of points before the wall.
core::Capture plate_capture(double z_m = 0.56) {
    core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({24, 24}, {0.04, 0.04}), {0.8, 0.016, 64});
    for (int ix = -10; ix <= 10; ++ix) {
        for (int iy = -10; iy <= 10; ++iy) {
            nlos_test::add_scatterer(capture, Vec3(0.02 * ix, 0.02 * iy, z_m), 4.0);
        }
    }
    return capture;
}

Reconstruction run(const core::Capture& capture, const std::vector<std::string>& overrides) {
    ReconstructSettings settings;
    settings.method = Method::Lct;
    for (const std::string& text : overrides) core::apply_override(settings, text);
    return reconstruct(capture, settings, {});
}

/// Root mean square difference of the maximum projection and the plate, both of maximum 1.
double error(const Reconstruction& result) {
    std::vector<float> image = max_projection(result.volume);
    const float largest = *std::max_element(image.begin(), image.end());
    double sum = 0.0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        const double x = result.volume.axes.x_m[i / 24];
        const double y = result.volume.axes.y_m[i % 24];
        const double plate = std::abs(x) < 0.21 && std::abs(y) < 0.21 ? 1.0 : 0.0;
        sum += std::pow(image[i] / largest - plate, 2);
    }
    return std::sqrt(sum / static_cast<double>(image.size()));
}

TEST(ConfocalSolver, SharpensANoisyPlateMoreThanTheWienerFilter) {
    core::Capture capture = plate_capture();
    const auto values = capture.transient.values();
    const float largest = *std::max_element(values.begin(), values.end());
    std::mt19937 generator(3);
    std::normal_distribution<float> noise(0.0F, 0.02F * largest);
    for (float& value : values) value += noise(generator);
    const double with_prior = error(run(capture, {"prior=tv"}));
    EXPECT_LT(with_prior, 0.8 * error(run(capture, {"snr=1"})));
    EXPECT_LT(with_prior, 0.8 * error(run(capture, {"snr=0.1"})));
}

// To a third of a bin, wherever in it the plate lies.
TEST(ConfocalSolver, FindsTheDepthOfThePlate) {
    constexpr double kBin = 0.008;
    for (const double z_m : {0.44, 0.442, 0.444, 0.446, 0.56}) {
        const Reconstruction result = run(plate_capture(z_m), {"prior=tv"});
        for (std::size_t ix = 8; ix < 16; ++ix) {
            for (std::size_t iy = 8; iy < 16; ++iy) {
                EXPECT_NEAR(result.depth.depth_m[result.depth.index(ix, iy)], z_m, kBin / 3.0);
            }
        }
    }
}

TEST(ConfocalSolver, IsZeroForDarkDataAndHasTheSameBitsForAnyNumberOfThreads) {
    core::Capture capture = plate_capture();
    const auto values = [&](int threads) {
        const core::ThreadLimit limit(threads);
        return run(capture, {"prior=tv", "solver.max_iterations=5"}).volume.values;
    };
    EXPECT_EQ(values(1), values(7));
    std::fill(capture.transient.values().begin(), capture.transient.values().end(), 0.0F);
    for (const float value : values(2)) ASSERT_EQ(value, 0.0F);
}

/// Standard deviation of the maximum projection inside the plate, over its mean.
double unevenness(const Reconstruction& result) {
    const std::vector<float> image = max_projection(result.volume);
    double count = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        const double x = result.volume.axes.x_m[i / 24];
        const double y = result.volume.axes.y_m[i % 24];
        if (std::abs(x) > 0.17 || std::abs(y) > 0.17) continue;
        const double value = static_cast<double>(image[i]);
        count += 1.0;
        sum += value;
        squares += value * value;
    }
    return std::sqrt(squares * count / (sum * sum) - 1.0);
}

// No point has a neighbour that tells noise, and few points pull weakly: the weights of the priors
// and the tolerance follow their fraction. Depths are within a voxel.
TEST(ConfocalSolver, FindsThePlateFromOnePointInSixteen) {
    core::Capture capture = plate_capture();
    std::vector<core::BinRange> observed;
    for (int ix = 0; ix < 24; ++ix) {
        for (int iy = 0; iy < 24; ++iy) {
            observed.push_back({0, (ix + 4 * iy) % 16 == 0 ? capture.time_axis.num_bins : 0});
        }
    }
    core::restrict_observed(capture, observed);
    const Reconstruction result = run(capture, {"prior=tv"});
    EXPECT_LT(error(result), 0.11);
    for (std::size_t ix = 9; ix < 15; ++ix) {
        for (std::size_t iy = 9; iy < 15; ++iy) {
            EXPECT_NEAR(result.depth.depth_m[result.depth.index(ix, iy)], 0.56, 0.008);
        }
    }
}

// Where three points in ten are dead without anybody saying so, these must not appear as structure.
TEST(ConfocalSolver, FindsTheGainsOfPointsWithTheScene) {
    core::Capture capture = plate_capture();
    const auto values = capture.transient.values();
    const float largest = *std::ranges::max_element(values);
    std::mt19937 generator(4);
    std::bernoulli_distribution is_dead(0.3);
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        const float gain = is_dead(generator) ? 0.0F : 300.0F / largest;
        for (float& value : capture.transient.histogram(pair)) {
            std::poisson_distribution<int> counts(std::max(1e-9F, gain * value));
            value = static_cast<float>(counts(generator));
        }
    }
    capture.unit = core::TransientUnit::Counts;
    const double without = unevenness(run(capture, {"prior=tv"}));
    EXPECT_LT(unevenness(run(capture, {"prior=tv", "solver.gains=true"})), 0.8 * without);
}

}  // namespace
}  // namespace nlos
