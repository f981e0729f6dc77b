// SPDX-License-Identifier: MIT
#include "nlos/solver/pair_operator.h"

#include "tests/nlos/methods/confocal_scene.h"
#include "tests/nlos/solver/adjoint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace nlos {
namespace {

using nlos_test::expect_adjoint;
using nlos_test::signed_values;

std::vector<double> rising_values(std::size_t count) {
    std::vector<double> values(count);
    std::iota(values.begin(), values.end(), 1.0);
    return values;
}

/// A scan of 40 points on an uneven wall, lit at 3 or at one of them.
core::Capture uneven_scan(core::ScanPattern pattern, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    core::Capture capture;
    capture.scan.wall().pattern = pattern;
    const auto add = [&](core::WallPoints& points, int count) {
        for (int i = 0; i < count; ++i) {
            points.positions.emplace_back(
                uniform(generator), uniform(generator), 0.05 * uniform(generator));
            points.normals.push_back(core::Vec3::UnitZ());
        }
    };
    add(capture.scan.wall().sensing, 40);
    capture.scan.wall().illumination = capture.scan.wall().sensing;
    if (pattern != core::ScanPattern::Confocal) {
        capture.scan.wall().illumination = {};
        add(capture.scan.wall().illumination, pattern == core::ScanPattern::Single ? 1 : 3);
    }
    capture.time_axis = {0.7, 0.02, 90};
    capture.transient = core::Transient(capture.scan.num_pairs(), 90);
    return capture;
}

TEST(PairOperator, AdjointIsExactForEveryPatternWithGapsAndResponse) {
    for (const auto pattern :
         {core::ScanPattern::Single, core::ScanPattern::Confocal, core::ScanPattern::Exhaustive}) {
        const core::Capture capture = uneven_scan(pattern, 8);
        std::vector<core::BinRange> observed(capture.scan.num_pairs(), {10, 80});
        observed[3] = {0, 0};
        const WallFrame wall = derive_wall_frame(capture.scan.wall());
        const core::Progress progress;
        const VolumeAxes axes{{0.0}, {0.0}, {0.5}, wall.world_from_wall};
        MethodInput input{capture.scan.wall(),
                          capture.time_axis,
                          capture.transient,
                          wall,
                          axes,
                          {0.4, 0.6},
                          progress,
                          &observed};
        input.measurement.response =
            core::sample_response(core::ExponentialGaussianResponse{0.02, 0.03}, 0.02);
        PairOperator light(input, Falloff::Retro, 0.08);
        PairGains gains(capture.scan.num_pairs());
        gains.update(std::vector<double>(capture.scan.num_pairs(), 5.0),
                     rising_values(capture.scan.num_pairs()));
        light.set_gains(gains);
        std::vector<Eigen::Vector3f> voxels;
        const std::vector<float> coordinates = signed_values(3000, 9);
        for (std::size_t i = 0; i < 1000; ++i) {
            voxels.emplace_back(0.6F * coordinates[3 * i],
                                0.6F * coordinates[3 * i + 1],
                                0.6F + 0.4F * coordinates[3 * i + 2]);
        }
        light.set_voxels(voxels);
        std::vector<std::size_t> pairs(capture.scan.num_pairs());
        std::iota(pairs.begin(), pairs.end(), std::size_t{0});
        const std::vector<float> x = signed_values(voxels.size(), 10);
        const std::vector<float> y = signed_values(pairs.size() * 90, 11);
        std::vector<float> ax(y.size());
        std::vector<float> aty(x.size());
        light.forward(x, pairs, ax);
        light.adjoint(y, pairs, aty);
        expect_adjoint(ax, y, x, aty);
        for (std::size_t bin = 0; bin < 90; ++bin) EXPECT_EQ(ax[3 * 90 + bin], 0.0F);
    }
}

TEST(PairOperator, ShowsAPointAsTheClosedFormDoes) {
    for (const Falloff falloff : {Falloff::Retro, Falloff::Diffuse, Falloff::Facing}) {
        core::Capture capture = uneven_scan(core::ScanPattern::Single, 12);
        const core::Vec3 point(0.1, -0.2, 0.6);
        nlos_test::add_scatterer(capture, point, falloff_power(falloff));
        const WallFrame wall = derive_wall_frame(capture.scan.wall());
        const core::Progress progress;
        const VolumeAxes axes{{0.0}, {0.0}, {0.5}, wall.world_from_wall};
        const MethodInput input{capture.scan.wall(),
                                capture.time_axis,
                                capture.transient,
                                wall,
                                axes,
                                {0.4, 0.6},
                                progress};
        PairOperator light(input, falloff, 0.0);
        const core::Transform to_wall = wall.world_from_wall.inverse(Eigen::Isometry);
        light.set_voxels({(to_wall * point).cast<float>()});
        const auto depth_from = [&](const core::Vec3& position) {
            return (to_wall * point).z() - (to_wall * position).z();
        };
        std::vector<std::size_t> pairs(40);
        std::iota(pairs.begin(), pairs.end(), std::size_t{0});
        std::vector<float> histograms(40 * 90);
        light.forward(std::vector<float>{1.0F}, pairs, histograms);
        const auto expected = capture.transient.values();
        const float largest = *std::ranges::max_element(expected);
        const double illumination_depth = depth_from(capture.scan.wall().illumination.positions[0]);
        for (std::size_t i = 0; i < histograms.size(); ++i) {
            const double depths =
                illumination_depth * depth_from(capture.scan.wall().sensing.positions[i / 90]);
            const double cosines = falloff == Falloff::Facing ? depths * depths : 1.0;
            ASSERT_NEAR(histograms[i], cosines * expected[i], 1e-4 * largest);
        }
    }
}

/// Mean histograms of a point seen from `capture`'s pairs moved about, each point by a normal
/// deviate of its own or, in a confocal scan, both by the same.
std::vector<double> histograms_of_spots(const core::Capture& capture,
                                        const core::Vec3& point,
                                        double deviation_m) {
    constexpr int kMoves = 20000;
    std::mt19937 generator(5);
    std::normal_distribution<double> normal(0.0, deviation_m);
    const core::WallScan& scan = capture.scan.wall();
    const core::TimeAxis& axis = capture.time_axis;
    std::vector<double> histograms(capture.transient.values().size(), 0.0);
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        const core::Vec3 l = scan.illumination.positions[scan.illumination_index(pair)];
        const core::Vec3 s = scan.sensing.positions[scan.sensing_index(pair)];
        const double value = std::pow((point - l).norm() * (point - s).norm(), -2.0) / kMoves;
        for (int i = 0; i < kMoves; ++i) {
            const core::Vec3 first(normal(generator), normal(generator), 0.0);
            core::Vec3 second = first;
            if (scan.pattern != core::ScanPattern::Confocal) {
                second = core::Vec3(normal(generator), normal(generator), 0.0);
            }
            const double opl = (point - l - first).norm() + (point - s - second).norm();
            const double bin = (opl - axis.opl_start_m) / axis.bin_width_m - 0.5;
            const auto before = static_cast<std::size_t>(bin);
            double* histogram = histograms.data() + pair * static_cast<std::size_t>(axis.num_bins);
            histogram[before] += value * (1.0 - (bin - std::floor(bin)));
            histogram[before + 1] += value * (bin - std::floor(bin));
        }
    }
    return histograms;
}

// A spot of 0.02 m deviation, seen from 0.6 m with a response of 0.06 m: it takes a tenth off the
// peak. Its second order and the deviates' own noise are a hundredth.
TEST(PairOperator, BlursASpotAsMovedPointsDo) {
    for (const auto pattern : {core::ScanPattern::Single, core::ScanPattern::Confocal}) {
        core::Capture capture = uneven_scan(pattern, 14);
        const core::Vec3 point(0.3, -0.2, 0.6);
        const WallFrame wall = derive_wall_frame(capture.scan.wall());
        const core::Progress progress;
        const VolumeAxes axes{{0.0}, {0.0}, {0.5}, wall.world_from_wall};
        MethodInput input{capture.scan.wall(),
                          capture.time_axis,
                          capture.transient,
                          wall,
                          axes,
                          {0.4, 0.6},
                          progress};
        input.measurement.response = core::sample_response(core::GaussianResponse{0.06}, 0.02);
        PairOperator light(input, Falloff::Diffuse, 0.02 * std::sqrt(8.0 * std::log(2.0)));
        light.set_voxels({(wall.world_from_wall.inverse(Eigen::Isometry) * point).cast<float>()});
        std::vector<std::size_t> pairs(40);
        std::iota(pairs.begin(), pairs.end(), std::size_t{0});
        std::vector<float> histograms(40 * 90);
        light.forward(std::vector<float>{1.0F}, pairs, histograms);
        const std::vector<double> moved = histograms_of_spots(capture, point, 0.02);
        for (std::size_t pair = 0; pair < 40; ++pair) {
            std::vector<double> expected(90);
            core::apply_filter(input.measurement.response,
                               std::span<const double>(moved).subspan(pair * 90, 90),
                               std::span<double>(expected));
            const double largest = *std::ranges::max_element(expected);
            for (std::size_t bin = 0; bin < 90; ++bin) {
                ASSERT_NEAR(static_cast<double>(histograms[pair * 90 + bin]),
                            expected[bin],
                            0.015 * largest)
                    << pair << ' ' << bin;
            }
        }
    }
}

}  // namespace
}  // namespace nlos
