// SPDX-License-Identifier: MIT
#include "nlos/preparation/conservative_resampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace nlos {
namespace {

TEST(ConservativeResampling, KeepsTheTotal) {
    const std::vector<double> from{0.0, 0.1, 0.4, 0.9, 1.6};
    const std::vector<double> to = even_edges(0.0, 1.6, 7);
    const ConservativeResampling resampling(from, to, std::vector<double>(4, 1.0));
    const std::vector<float> input{1.0F, 5.0F, 2.0F, 3.0F};
    std::vector<float> output(resampling.num_outputs());
    resampling.apply(input.data(), output.data());
    EXPECT_NEAR(std::accumulate(output.begin(), output.end(), 0.0), 11.0, 1e-5);
}

TEST(ConservativeResampling, SplitsABinByOverlap) {
    const std::vector<double> from{0.0, 1.0};
    const std::vector<double> to{-1.0, 0.25, 0.5, 3.0};
    const ConservativeResampling resampling(from, to, std::vector<double>{2.0});
    const std::vector<float> input{10.0F};
    std::vector<float> output(3);
    resampling.apply(input.data(), output.data());
    EXPECT_FLOAT_EQ(output[0], 5.0F);
    EXPECT_FLOAT_EQ(output[1], 5.0F);
    EXPECT_FLOAT_EQ(output[2], 10.0F);
}

TEST(ConservativeResampling, MakesDensitiesLinearBetweenMiddles) {
    const std::vector<double> from = even_edges(0.0, 10.0, 10);
    const std::vector<double> to{1.0, 2.3, 2.4, 4.0, 6.7, 9.0};
    const ConservativeResampling resampling(
        from, to, std::vector<double>(10, 1.0), BinSpread::Linear);
    std::vector<float> ramp;
    for (int i = 0; i < 10; ++i) ramp.push_back(static_cast<float>(i) + 0.5F);
    std::vector<float> output(5);
    resampling.apply(ramp.data(), output.data());
    for (std::size_t i = 0; i < output.size(); ++i) {
        EXPECT_NEAR(output[i], 0.5 * (to[i + 1] * to[i + 1] - to[i] * to[i]), 1e-5);
    }
}

TEST(ConservativeResampling, KeepsTheTotalOfLinearDensities) {
    const std::vector<double> from{0.0, 0.1, 0.4, 0.9, 1.6};
    const std::vector<double> to = even_edges(-1.0, 2.5, 9);
    const ConservativeResampling resampling(
        from, to, std::vector<double>(4, 1.0), BinSpread::Linear);
    const std::vector<float> input{1.0F, 5.0F, 2.0F, 3.0F};
    std::vector<float> output(resampling.num_outputs());
    resampling.apply(input.data(), output.data());
    EXPECT_NEAR(std::accumulate(output.begin(), output.end(), 0.0), 11.0, 1e-5);
}

TEST(ConservativeResampling, IgnoresEmptyBins) {
    const std::vector<double> from{0.0, 0.0, 1.0};
    const std::vector<double> to{0.0, 1.0};
    const ConservativeResampling resampling(from, to, std::vector<double>(2, 1.0));
    const std::vector<float> input{7.0F, 3.0F};
    float output = 0.0F;
    resampling.apply(input.data(), &output);
    EXPECT_FLOAT_EQ(output, 3.0F);
}

TEST(ConservativeResampling, TreatsManyHistogramsAsEachAlone) {
    constexpr std::size_t kCount = 11, kInputs = 40;
    const std::vector<double> from = even_edges(0.0, 1.0, kInputs);
    std::vector<double> to = even_edges(0.0, 1.0, 25);
    for (double& edge : to) edge *= edge;  // few inputs here, many there
    const ConservativeResampling resampling(from, to, std::vector<double>(kInputs, 1.0));
    std::vector<float> inputs;
    for (std::size_t i = 0; i < kCount * kInputs; ++i) {
        inputs.push_back(static_cast<float>(i * i % 17));
    }
    std::vector<float> outputs(kCount * resampling.num_outputs());
    std::vector<const float*> from_each;
    std::vector<float*> to_each;
    for (std::size_t i = 0; i < kCount; ++i) {
        from_each.push_back(inputs.data() + i * kInputs);
        to_each.push_back(outputs.data() + i * resampling.num_outputs());
    }
    resampling.apply(from_each, to_each);
    for (std::size_t i = 0; i < kCount; ++i) {
        std::vector<float> alone(resampling.num_outputs());
        resampling.apply(from_each[i], alone.data());
        EXPECT_TRUE(std::equal(alone.begin(), alone.end(), to_each[i])) << i;
    }
}

}  // namespace
}  // namespace nlos
