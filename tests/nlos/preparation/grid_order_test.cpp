// SPDX-License-Identifier: MIT
#include "nlos/preparation/grid_order.h"

#include "nlos/preparation/wall_frame.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace nlos {
namespace {

using core::Vec3;
using core::WallPoints;
using core::WallScan;
using nlos_test::wall_grid;

WallScan confocal_scan(const WallPoints& points) {
    WallScan scan;
    scan.sensing = points;
    scan.illumination = points;
    return scan;
}

/// The points in random order, as a list.
WallPoints shuffled(const WallPoints& points, std::mt19937& generator) {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::shuffle(order, generator);
    WallPoints list;
    for (const std::size_t i : order) {
        list.positions.push_back(points.positions[i]);
        list.normals.push_back(points.normals[i]);
    }
    return list;
}

TEST(SortIntoGrids, ShuffledPointsBecomeTheGridThatTheyFill) {
    std::mt19937 generator(1);
    for (const auto& size : {std::array<std::size_t, 2>{7, 5}, {2, 2}, {3, 40}, {64, 64}}) {
        const WallPoints grid = wall_grid(size, {0.03, 0.02});
        WallScan scan = confocal_scan(shuffled(grid, generator));
        const WallScan list = scan;
        const std::vector<std::size_t> numbers = sort_into_grids(scan);
        ASSERT_TRUE(scan.sensing.grid);
        EXPECT_EQ(*scan.sensing.grid, size);
        EXPECT_EQ(scan.sensing.positions, grid.positions);
        EXPECT_EQ(scan.illumination.positions, grid.positions);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            EXPECT_EQ(list.sensing.positions[numbers[i]], scan.sensing.positions[i]);
        }
    }
}

TEST(SortIntoGrids, AnyWallAndJitterBelowTheToleranceOfGridsWill) {
    std::mt19937 generator(2);
    std::uniform_real_distribution<double> jitter(-2e-5, 2e-5);  // a thousandth of the pitch
    core::Transform pose = core::Transform::Identity();
    pose.translate(Vec3(3.0, -2.0, 1.5));
    pose.rotate(Eigen::AngleAxisd(2.1, Vec3(0.3, 1.0, -0.2).normalized()));
    WallPoints grid = wall_grid({2, 90}, {0.02, 0.02}, pose);
    for (Vec3& position : grid.positions) {
        position += Vec3(jitter(generator), jitter(generator), jitter(generator));
    }
    WallScan scan = confocal_scan(shuffled(grid, generator));
    sort_into_grids(scan);
    EXPECT_TRUE(derive_wall_frame(scan).grid) << derive_wall_frame(scan).why_no_grid;
}

TEST(SortIntoGrids, AGridOfOneColumnOrTheWrongShapeIsOneTooWhereItFillsAnother) {
    WallPoints points = wall_grid({6, 4}, {0.02, 0.02});
    for (const auto& size : {std::array<std::size_t, 2>{24, 1}, {1, 24}, {3, 8}}) {
        points.grid = size;
        WallScan scan = confocal_scan(points);
        sort_into_grids(scan);
        EXPECT_EQ(*scan.sensing.grid, (std::array<std::size_t, 2>{6, 4}));
    }
}

TEST(SortIntoGrids, WhatFillsNoGridStaysAsItIs) {
    std::mt19937 generator(3);
    const WallPoints grid = wall_grid({6, 6}, {0.02, 0.02});
    WallPoints missing = shuffled(grid, generator);
    missing.positions.pop_back();
    missing.normals.pop_back();
    WallPoints bent = shuffled(grid, generator);
    for (Vec3& position : bent.positions) position.z() = 3.0 * position.x() * position.x();
    WallPoints uneven = shuffled(grid, generator);
    uneven.positions[11] += Vec3(0.002, 0.0, 0.0);
    const WallPoints row = wall_grid({36, 1}, {0.02, 0.02});
    for (const WallPoints& points : {missing, bent, uneven, row}) {
        WallScan scan = confocal_scan(points);
        const std::vector<std::size_t> numbers = sort_into_grids(scan);
        EXPECT_TRUE(std::ranges::is_sorted(numbers));
        EXPECT_EQ(scan.sensing.grid, points.grid);
        EXPECT_EQ(scan.sensing.positions, points.positions);
    }
}

TEST(SortIntoGrids, LitAndSeenPointsAreSortedEachForItself) {
    std::mt19937 generator(4);
    WallScan scan;
    scan.pattern = core::ScanPattern::Exhaustive;
    scan.illumination = shuffled(wall_grid({3, 2}, {0.1, 0.1}), generator);
    scan.sensing = shuffled(wall_grid({4, 5}, {0.02, 0.02}), generator);
    const WallScan list = scan;
    const std::vector<std::size_t> numbers = sort_into_grids(scan);
    ASSERT_EQ(numbers.size(), list.num_pairs());
    for (std::size_t pair = 0; pair < numbers.size(); ++pair) {
        EXPECT_EQ(scan.illumination_point(pair), list.illumination_point(numbers[pair]));
        EXPECT_EQ(scan.sensing_point(pair), list.sensing_point(numbers[pair]));
    }
}

}  // namespace
}  // namespace nlos
