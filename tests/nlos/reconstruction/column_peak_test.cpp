// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/column_peak.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace nlos {
namespace {

constexpr int kVoxels = 15;
constexpr std::size_t kMiddle = 7;

double position_of(const std::vector<float>& column) {
    const auto brightest = std::max_element(column.begin(), column.end()) - column.begin();
    return find_peak(column, static_cast<std::size_t>(brightest)).position;
}

TEST(ColumnPeak, IsTheCentreOfAGaussian) {
    for (const double deviation : {0.8, 1.0, 1.5, 3.0}) {
        for (const double offset : {-0.5, -0.3, 0.0, 0.1, 0.49}) {
            std::vector<float> column;
            for (int i = 0; i < kVoxels; ++i) {
                const double z = (i - (kMiddle + offset)) / deviation;
                column.push_back(static_cast<float>(std::exp(-0.5 * z * z)));
            }
            EXPECT_NEAR(position_of(column), kMiddle + offset, 1e-4) << deviation << " " << offset;
        }
    }
}

// What a sparse solution makes of light between two voxels: two values whose mean is in its place.
TEST(ColumnPeak, OfLightSplitBetweenTwoVoxelsIsNearTheirMean) {
    for (const double fraction : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9}) {
        for (const float beside : {0.0F, 1e-6F}) {
            std::vector<float> column(kVoxels, beside);
            column[kMiddle] = static_cast<float>(1.0 - fraction);
            column[kMiddle + 1] = static_cast<float>(fraction);
            EXPECT_NEAR(position_of(column), kMiddle + fraction, 0.04) << fraction << " " << beside;
        }
    }
}

TEST(ColumnPeak, OfThreeVoxelsWithAnEmptyNeighbourIsNearTheirMean) {
    const std::array<float, 3> values{0.233F, 0.647F, 1.0F};
    std::vector<float> column(kVoxels, 0.0F);
    std::copy(values.begin(), values.end(), column.begin() + kMiddle);
    const double mean =
        (values[1] + 2.0 * values[2]) / std::accumulate(values.begin(), values.end(), 0.0);
    EXPECT_NEAR(position_of(column), kMiddle + mean, 0.15);
}

TEST(ColumnPeak, AtTheEndsIsAVoxel) {
    EXPECT_EQ(position_of({1.0F, 0.5F, 0.0F}), 0.0);
    EXPECT_EQ(position_of({0.0F, 0.5F, 1.0F}), 2.0);
    EXPECT_EQ(position_of({0.0F, 0.0F, 0.0F}), 0.0);
}

TEST(ColumnPeak, IsFoundUphill) {
    const std::vector<float> column{0.0F, 0.1F, 0.3F, 0.8F, 1.0F, 0.8F, 0.0F};
    EXPECT_EQ(find_peak(column, 2).voxel, 4U);
}

}  // namespace
}  // namespace nlos
