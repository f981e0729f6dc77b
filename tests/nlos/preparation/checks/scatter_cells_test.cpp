// SPDX-License-Identifier: MIT
#include "nlos/preparation/checks/scatter_cells.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nlos {
namespace {

using core::Vec3;

constexpr std::size_t kBins = 30;
constexpr double kStart_m = 0.6;
constexpr double kWidth_m = 0.08;

/// Pairs on a wall at z = 0, of which every third did not observe some of its bins.
struct ScatterExample {
    HistogramSample sample;
    PathGeometry geometry;
    ScatterCells cells = coarse_cells(0.3, 1.5);

    explicit ScatterExample(bool observes_all = false) {
        sample.num_bins = kBins;
        for (std::size_t i = 0; i < 27; ++i) {  // not a whole number of blocks
            const double x = 0.1 * static_cast<double>(i % 6) - 0.25;
            const double y = 0.1 * static_cast<double>(i / 6) - 0.2;
            sample.pairs.push_back(i);
            geometry.illumination.emplace_back(x, y, 0.0);
            geometry.sensing.emplace_back(i % 2 == 0 ? x : 0.3 - x, y, 0.0);
            geometry.segments_m.push_back(0.01 * static_cast<double>(i));
            for (std::size_t bin = 0; bin < kBins; ++bin) {
                const bool is_observed = observes_all || i % 3 > 0 || (bin > 3 && bin != 12);
                sample.observed.push_back(is_observed ? 1.0F : 0.0F);
            }
        }
        geometry.opl_start_m = kStart_m;
        geometry.bin_width_m = kWidth_m;
    }

    ScatterTransport transport() const { return {sample, geometry, cells}; }
};

std::vector<double> some_light(std::size_t count) {
    std::vector<double> light;
    for (std::size_t i = 0; i < count; ++i) light.push_back(static_cast<double>(i * i % 11));
    return light;
}

TEST(ScatterTransport, PutsACellsLightWhereItsPathsEnd) {
    const ScatterExample example(true);
    const ScatterTransport transport = example.transport();
    const std::size_t cell = example.cells.centers.size() / 3;
    const auto center = example.cells.centers[cell];
    const double z = std::sqrt(1.0 - center.y() * center.y() - center.z() * center.z());
    const Vec3 position = center.x() * Vec3(center.y(), center.z(), z);
    std::vector<double> light(example.cells.centers.size(), 0.0);
    light[cell] = 1.0;
    const std::vector<float> model = transport.forward(light, {});
    std::size_t num_seen = 0;
    for (std::size_t pair = 0; pair < example.sample.pairs.size(); ++pair) {
        const double length = (position - example.geometry.illumination[pair]).norm() +
                              (position - example.geometry.sensing[pair]).norm() +
                              example.geometry.segments_m[pair];
        const double expected = (length - kStart_m) / kWidth_m - 0.5;
        if (expected < 0.0 || expected > static_cast<double>(kBins - 1)) continue;
        double sum = 0.0;
        double moment = 0.0;
        for (std::size_t bin = 0; bin < kBins; ++bin) {
            const auto value = static_cast<double>(model[pair * kBins + bin]);
            sum += value;
            moment += static_cast<double>(bin) * value;
        }
        ASSERT_GT(sum, 0.0);
        EXPECT_NEAR(moment / sum, expected, 1e-3);  // single precision of some 30 bins
        ++num_seen;
    }
    EXPECT_GT(num_seen, 20U);
}

/// <ratio, gain A light> = <light, A' gain ratio>, by subsets and with bins that nobody observed.
TEST(ScatterTransport, BackwardIsTheAdjointOfForward) {
    const ScatterExample example;
    const ScatterTransport transport = example.transport();
    const std::vector<double> light = some_light(example.cells.centers.size());
    std::vector<float> ratio;
    for (std::size_t i = 0; i < example.sample.observed.size(); ++i) {
        ratio.push_back(example.sample.observed[i] * static_cast<float>(i % 5));
    }
    std::vector<double> gain;
    for (std::size_t pair = 0; pair < example.sample.pairs.size(); ++pair) {
        gain.push_back(0.5 + 0.1 * static_cast<double>(pair % 4));
    }
    for (const PairSubset& subset : {PairSubset{0, 1}, PairSubset{1, 2}, PairSubset{2, 6}}) {
        const std::vector<float> model = transport.forward(light, subset);
        double forward = 0.0;
        for (std::size_t i = 0; i < model.size(); ++i) {
            forward += gain[i / kBins] * static_cast<double>(ratio[i] * model[i]);
        }
        const CellReach reach = transport.backward(ratio, gain, subset);
        double backward = 0.0;
        for (std::size_t c = 0; c < light.size(); ++c) {
            backward += light[c] * static_cast<double>(reach.rated[c]);
        }
        ASSERT_GT(forward, 0.0);
        EXPECT_NEAR(backward / forward, 1.0, 1e-5);
    }
}

TEST(ScatterTransport, ReachIsWhatUnitLightSends) {
    for (const bool observes_all : {true, false}) {
        const ScatterExample example(observes_all);
        const ScatterTransport transport = example.transport();
        const std::vector<double> ones(example.sample.pairs.size(), 1.0);
        const std::vector<float> expected =
            transport.backward(example.sample.observed, ones, {}).plain;
        ASSERT_EQ(transport.reach().size(), expected.size());
        for (std::size_t c = 0; c < expected.size(); ++c) {
            EXPECT_NEAR(transport.reach()[c], expected[c], 1e-5F * (1.0F + expected[c])) << c;
        }
    }
}

}  // namespace
}  // namespace nlos
