// SPDX-License-Identifier: MIT
#include "nlos/methods/backprojection.h"

#include "nlos/reconstruction/surface.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace nlos {
namespace {

using core::ScanPattern;
using core::Vec3;

constexpr std::array kCompensations{Compensation::None, Compensation::Diffuse, Compensation::Retro};

struct Problem {
    core::WallScan scan;
    core::TimeAxis axis{0.35, 0.02, 60};
    VolumeAxes voxels;
    Compensation compensation = Compensation::None;

    std::size_t num_values() const {
        return scan.num_pairs() * static_cast<std::size_t>(axis.num_bins);
    }
};

Problem make_problem(ScanPattern pattern) {
    Problem problem;
    problem.scan.pattern = pattern;
    problem.scan.sensing = nlos_test::wall_grid({5, 7}, {0.05, 0.03});
    problem.scan.illumination = problem.scan.sensing;
    if (pattern == ScanPattern::Single) {
        problem.scan.illumination = nlos_test::wall_grid({1, 1}, {1.0, 1.0});
    }
    if (pattern == ScanPattern::Exhaustive) {
        problem.scan.illumination = nlos_test::wall_grid({3, 2}, {0.04, 0.07});
    }
    problem.scan.laser_position = Vec3(-0.1, 0.2, -0.3);
    problem.scan.detector_position = Vec3(0.2, 0.1, -0.25);
    problem.voxels.x_m = cell_centers(-0.125, 0.125, 5);
    problem.voxels.y_m = cell_centers(-0.105, 0.105, 7);
    problem.voxels.z_m = cell_centers(0.1, 0.6, 9);
    return problem;
}

std::vector<double> random_values(std::size_t count, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<double> values(count);
    for (double& value : values) value = uniform(generator);
    return values;
}

PairList<double> pair_list(const Problem& problem, std::span<const double> histograms) {
    const core::WallScan& scan = problem.scan;
    PairList<double> data{scan.pattern,
                          problem.axis,
                          histograms,
                          scan.illumination.positions,
                          scan.sensing.positions,
                          std::vector<double>(scan.illumination.size(), 0.0),
                          std::vector<double>(scan.sensing.size(), 0.0),
                          problem.compensation};
    if (scan.opl_origin == core::OplOrigin::Device) {
        for (std::size_t i = 0; i < scan.illumination.size(); ++i) {
            data.illumination_segments_m[i] =
                (scan.illumination.positions[i] - scan.laser_position).norm();
        }
        for (std::size_t i = 0; i < scan.sensing.size(); ++i) {
            data.sensing_segments_m[i] =
                (scan.sensing.positions[i] - scan.detector_position).norm();
        }
    }
    return data;
}

std::vector<double> run_pairs(const Problem& problem, std::span<const double> histograms) {
    std::vector<double> volume(problem.voxels.num_voxels(), 0.0);
    backproject_pairs<double>(pair_list(problem, histograms), problem.voxels, volume, {});
    return volume;
}

std::vector<double> run_pairs_in_float(const Problem& problem, std::span<const double> histograms) {
    const std::vector<float> rounded(histograms.begin(), histograms.end());
    const PairList<double> exact = pair_list(problem, histograms);
    const PairList<float> data{exact.pattern,
                               exact.time_axis,
                               rounded,
                               exact.illumination,
                               exact.sensing,
                               exact.illumination_segments_m,
                               exact.sensing_segments_m,
                               exact.compensation};
    std::vector<float> volume(problem.voxels.num_voxels(), 0.0F);
    backproject_pairs<float>(data, problem.voxels, volume, {});
    return {volume.begin(), volume.end()};
}

std::vector<double> run_grid(const Problem& problem, std::span<const double> histograms) {
    const WallFrame wall = derive_wall_frame(problem.scan);
    std::vector<double> volume(problem.voxels.num_voxels(), 0.0);
    backproject_confocal_grid<double>(
        {*wall.grid, problem.axis, histograms, {}, problem.compensation},
        problem.voxels,
        volume,
        {});
    return volume;
}

double lost_light(Compensation compensation, double product_of_segments) {
    if (compensation == Compensation::None) return 1.0;
    return std::pow(product_of_segments, compensation == Compensation::Diffuse ? 2.0 : 1.0);
}

/// The forward model that backprojection transposes: each voxel's light enters the two bins whose
/// centres enclose its path length.
std::vector<double> project(const Problem& problem, std::span<const double> volume) {
    std::vector<double> histograms(problem.num_values(), 0.0);
    const VolumeAxes& voxels = problem.voxels;
    const int num_bins = problem.axis.num_bins;
    for (std::size_t pair = 0; pair < problem.scan.num_pairs(); ++pair) {
        const Vec3& l = problem.scan.illumination.positions[problem.scan.illumination_index(pair)];
        const Vec3& s = problem.scan.sensing.positions[problem.scan.sensing_index(pair)];
        std::size_t i = 0;
        for (const double x : voxels.x_m) {
            for (const double y : voxels.y_m) {
                for (const double z : voxels.z_m) {
                    const Vec3 p(x, y, z);
                    const double opl =
                        (l - p).norm() + (p - s).norm() + problem.scan.device_segments_m(pair);
                    const double factor =
                        lost_light(problem.compensation, (l - p).norm() * (p - s).norm());
                    const double position =
                        (opl - problem.axis.opl_start_m) / problem.axis.bin_width_m - 0.5;
                    for (int bin = 0; bin < num_bins; ++bin) {
                        const double weight =
                            factor * std::max(0.0, 1.0 - std::abs(position - bin));
                        histograms[pair * static_cast<std::size_t>(num_bins) +
                                   static_cast<std::size_t>(bin)] += weight * volume[i];
                    }
                    ++i;
                }
            }
        }
    }
    return histograms;
}

double dot(std::span<const double> a, std::span<const double> b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

void expect_equal(std::span<const double> a, std::span<const double> b, double tolerance) {
    ASSERT_EQ(a.size(), b.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
    EXPECT_LT(worst, tolerance);
}

TEST(Backprojection, OfPairsIsTheAdjointOfTheForwardModel) {
    for (const ScanPattern pattern :
         {ScanPattern::Single, ScanPattern::Confocal, ScanPattern::Exhaustive}) {
        for (const core::OplOrigin origin : {core::OplOrigin::RelayWall, core::OplOrigin::Device}) {
            Problem problem = make_problem(pattern);
            problem.scan.opl_origin = origin;
            const auto x = random_values(problem.voxels.num_voxels(), 1);
            const auto y = random_values(problem.num_values(), 2);
            for (const Compensation compensation : kCompensations) {
                problem.compensation = compensation;
                const double forward = dot(project(problem, x), y);
                EXPECT_NEAR(dot(x, run_pairs(problem, y)), forward, 1e-10 * std::abs(forward));
            }
        }
    }
}

TEST(Backprojection, OfAConfocalGridIsTheAdjointOfTheForwardModel) {
    Problem problem = make_problem(ScanPattern::Confocal);
    const auto x = random_values(problem.voxels.num_voxels(), 3);
    const auto y = random_values(problem.num_values(), 4);
    for (const Compensation compensation : kCompensations) {
        problem.compensation = compensation;
        const double forward = dot(project(problem, x), y);
        EXPECT_NEAR(dot(x, run_grid(problem, y)), forward, 1e-10 * std::abs(forward));
    }
}

TEST(Backprojection, OfAConfocalGridEqualsThatOfPairsOnAnyCommonLattice) {
    for (const std::size_t num_y : {1, 7, 14, 21, 28}) {
        Problem problem = make_problem(ScanPattern::Confocal);
        problem.voxels.x_m = cell_centers(-0.2, 0.15, 6);  // any spacing serves along x
        problem.voxels.y_m = cell_centers(-0.105, 0.105, num_y);
        const auto y = random_values(problem.num_values(), 5);
        expect_equal(run_grid(problem, y), run_pairs(problem, y), 1e-10);
    }
    Problem coarse = make_problem(ScanPattern::Confocal);
    coarse.scan.sensing = nlos_test::wall_grid({4, 24}, {0.05, 0.01});
    coarse.scan.illumination = coarse.scan.sensing;
    for (const std::size_t num_y : {12, 16, 18}) {
        coarse.voxels.y_m = cell_centers(-0.12, 0.12, num_y);
        const auto y = random_values(coarse.num_values(), 6);
        expect_equal(run_grid(coarse, y), run_pairs(coarse, y), 1e-10);
    }
}

TEST(Backprojection, RefusesTheFastWayWithoutACommonLattice) {
    Problem problem = make_problem(ScanPattern::Confocal);
    const WallFrame wall = derive_wall_frame(problem.scan);
    EXPECT_TRUE(common_lattice(*wall.grid, problem.voxels.y_m));
    problem.voxels.y_m = cell_centers(-0.105, 0.105, 11);
    EXPECT_FALSE(common_lattice(*wall.grid, problem.voxels.y_m));
}

TEST(Backprojection, OfACaptureCountingDownEqualsThatOfPairs) {
    Problem problem = make_problem(ScanPattern::Confocal);
    for (auto* points : {&problem.scan.sensing, &problem.scan.illumination}) {
        for (Vec3& position : points->positions) position.y() = -position.y();
    }
    const auto y = random_values(problem.num_values(), 7);
    expect_equal(run_grid(problem, y), run_pairs(problem, y), 1e-10);
}

TEST(Backprojection, OfAGridTakesDeviceSegmentsOffByFractionsOfABin) {
    const auto points = nlos_test::wall_grid({8, 8}, {0.05, 0.05});
    core::Capture capture = nlos_test::confocal_capture(points, {1.0, 0.01, 200});
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    capture.scan.wall().laser_position = Vec3(0.3, 0.1, -0.5);
    capture.scan.wall().detector_position = Vec3(-0.3, 0.2, -0.6);
    const Vec3 scatterer(0.025, -0.075, 0.5);
    nlos_test::add_scatterer(capture, scatterer, 0.0);
    VolumeAxes voxels;
    voxels.x_m = cell_centers(-0.2, 0.2, 8);
    voxels.y_m = voxels.x_m;
    voxels.z_m = cell_centers(0.4, 0.6, 41);
    const WallFrame wall = derive_wall_frame(capture.scan.wall());
    const core::Progress progress;
    const Volume volume = backproject({capture.scan.wall(),
                                       capture.time_axis,
                                       capture.transient,
                                       wall,
                                       voxels,
                                       {0.4, 0.6},
                                       progress},
                                      {},
                                      1);
    // A bin covers 5 mm of depth: segments rounded to whole bins would smear and shift the peak.
    EXPECT_LT((nlos_test::brightest_point(volume) - scatterer).norm(), 5e-4);
}

TEST(Backprojection, HasTheSameBitsForAnyNumberOfThreads) {
    const Problem problem = make_problem(ScanPattern::Confocal);
    const auto y = random_values(problem.num_values(), 8);
    const auto run = [&](int threads) {
        const core::ThreadLimit limit(threads);
        return std::pair(run_grid(problem, y), run_pairs(problem, y));
    };
    EXPECT_EQ(run(1), run(7));
}

// In single precision vectors of voxels search the bins they share: fine and coarse rows of voxels,
// before and behind the wall, within and off the axis. Positions are right to 1e-5 bins, values
// between -1 and 1, of which 35 or more are summed.
TEST(Backprojection, VectorsOfVoxelsEqualOneByOne) {
    for (const auto pattern :
         {ScanPattern::Confocal, ScanPattern::Single, ScanPattern::Exhaustive}) {
        for (const Compensation compensation : kCompensations) {
            for (const std::size_t num_z : {7U, 40U, 300U, 1100U}) {
                Problem problem = make_problem(pattern);
                problem.compensation = compensation;
                problem.voxels.z_m = cell_centers(-0.4, 1.4, num_z);
                const auto histograms = random_values(problem.num_values(), 11);
                const auto exact = run_pairs(problem, histograms);
                const auto found = run_pairs_in_float(problem, histograms);
                double largest = 0.0;
                for (const double value : exact) largest = std::max(largest, std::abs(value));
                for (std::size_t i = 0; i < exact.size(); ++i) {
                    ASSERT_NEAR(found[i], exact[i], 2e-5 * largest) << num_z << ", voxel " << i;
                }
            }
        }
    }
}

}  // namespace
}  // namespace nlos
