// SPDX-License-Identifier: MIT
#include "nlos/solver/pair_solver.h"

#include "nlos/reconstruct.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nlos {
namespace {

/// A plate of points 0.5 m before 300 random points of a wall with 5 cm of relief, lit at one spot.
core::Capture plate_before_uneven_wall(double photons_of_brightest_bin) {
    std::mt19937 generator(2);
    std::uniform_real_distribution<double> uniform(-0.4, 0.4);
    core::Capture capture;
    capture.scan.wall().pattern = core::ScanPattern::Single;
    for (int i = 0; i < 300; ++i) {
        const double x = uniform(generator);
        const double y = uniform(generator);
        capture.scan.wall().sensing.positions.emplace_back(
            x, y, 0.025 * std::sin(7.0 * x + 3.0 * y));
        capture.scan.wall().sensing.normals.push_back(core::Vec3::UnitZ());
    }
    capture.scan.wall().illumination.positions.push_back(core::Vec3::Zero());
    capture.scan.wall().illumination.normals.push_back(core::Vec3::UnitZ());
    capture.time_axis = {0.8, 0.016, 64};
    capture.transient = core::Transient(300, 64);
    for (int ix = -8; ix <= 8; ++ix) {
        for (int iy = -8; iy <= 8; ++iy) {
            nlos_test::add_scatterer(capture, core::Vec3(0.02 * ix, 0.02 * iy, 0.5), 4.0);
        }
    }
    if (photons_of_brightest_bin > 0.0) {
        const auto values = capture.transient.values();
        const double largest = static_cast<double>(*std::ranges::max_element(values));
        for (float& value : values) {
            if (!(value > 0.0F)) continue;
            std::poisson_distribution<int> counts(photons_of_brightest_bin *
                                                  static_cast<double>(value) / largest);
            value = static_cast<float>(counts(generator));
        }
        capture.unit = core::TransientUnit::Counts;
    }
    return capture;
}

Reconstruction solve_plate(const core::Capture& capture,
                           const std::vector<std::string>& overrides = {}) {
    ReconstructSettings settings;
    settings.method = Method::Solver;
    core::apply_override(settings, "volume.voxels=[25,25,64]");
    for (const std::string& text : overrides) core::apply_override(settings, text);
    return reconstruct(capture, settings, {});
}

/// Mean depth error over the inner columns of the plate [m].
double depth_error(const Reconstruction& result) {
    double error = 0.0;
    double count = 0.0;
    for (std::size_t ix = 0; ix < 25; ++ix) {
        for (std::size_t iy = 0; iy < 25; ++iy) {
            if (std::abs(result.depth.x_m[ix]) > 0.13) continue;
            if (std::abs(result.depth.y_m[iy]) > 0.13) continue;
            EXPECT_TRUE(result.depth.is_foreground(result.depth.index(ix, iy)));
            error += std::abs(result.depth.point_world(ix, iy).z() - 0.5);
            count += 1.0;
        }
    }
    EXPECT_GT(count, 40.0);
    return error / count;
}

TEST(PairSolver, FindsAPlateBeforeAnUnevenWall) {
    // Noise-free, and with 20 counts in the brightest bin: on average within a seventh of a voxel
    // of 8 mm, and within a fifth.
    for (const double counts : {0.0, 20.0}) {
        EXPECT_LT(depth_error(solve_plate(plate_before_uneven_wall(counts))),
                  counts > 0.0 ? 0.0016 : 0.0012)
            << counts;
    }
}

/// The fraction of all albedo that is on the plate.
double fraction_on_plate(const Reconstruction& result) {
    double plate = 0.0;
    double all = 0.0;
    const VolumeAxes& axes = result.volume.axes;
    for (std::size_t i = 0; i < result.volume.values.size(); ++i) {
        const core::Vec3 position =
            axes.world_from_wall *
            core::Vec3(axes.x_m[i / (25 * 64)], axes.y_m[i / 64 % 25], axes.z_m[i % 64]);
        const double value = static_cast<double>(result.volume.values[i]);
        EXPECT_GE(value, 0.0);
        all += value;
        const bool is_plate = std::abs(position.x()) < 0.2 && std::abs(position.y()) < 0.2 &&
                              std::abs(position.z() - 0.5) < 0.02;
        if (is_plate) plate += value;
    }
    return plate / all;
}

TEST(PairSolver, LeavesNothingBesideThePlate) {
    EXPECT_GT(fraction_on_plate(solve_plate(plate_before_uneven_wall(20.0))), 0.95);
}

// A wall whose reflectance varies sixteenfold from left to right.
TEST(PairSolver, FindsTheGainsOfPointsWithTheScene) {
    core::Capture capture = plate_before_uneven_wall(400.0);
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        const double x = capture.scan.wall().sensing.positions[pair].x();
        const auto gain = static_cast<float>(std::exp2(5.0 * (x - 0.4)));
        for (float& value : capture.transient.histogram(pair)) value = std::round(gain * value);
    }
    const double beside = 1.0 - fraction_on_plate(solve_plate(capture, {"solver.gains=true"}));
    EXPECT_LT(beside, 0.75 * (1.0 - fraction_on_plate(solve_plate(capture))));
}

// As much background in every bin as a tenth of the brightest one's light.
TEST(PairSolver, ExplainsBackgroundAsBackground) {
    core::Capture capture = plate_before_uneven_wall(100.0);
    std::mt19937 generator(7);
    std::poisson_distribution<int> background(10.0);
    for (float& value : capture.transient.values()) {
        value += static_cast<float>(background(generator));
    }
    const Reconstruction result = solve_plate(capture, {"noise_floor=10"});
    EXPECT_GT(fraction_on_plate(result), 0.85);
    EXPECT_LT(depth_error(result), 0.003);
}

TEST(PairSolver, TakesTheSameBitsForAnyNumberOfThreads) {
    const core::Capture capture = plate_before_uneven_wall(5.0);
    const auto values = [&](int threads) {
        const core::ThreadLimit limit(threads);
        return solve_plate(capture).volume.values;
    };
    EXPECT_EQ(values(1), values(7));
}

TEST(PairSolver, FindsNothingInDarkness) {
    core::Capture capture = plate_before_uneven_wall(0.0);
    std::ranges::fill(capture.transient.values(), 0.0F);
    for (const float value : solve_plate(capture).volume.values) ASSERT_EQ(value, 0.0F);
}

}  // namespace
}  // namespace nlos
