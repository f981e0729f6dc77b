// SPDX-License-Identifier: MIT
#include "calib/model/wall_motion.h"

#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using calib::MovedWallPoint;
using calib::WallMotion;
using core::Vec3;

// Two levels of a stepped wall, which are parallel to it.
core::WallScan stepped_scan() {
    std::vector<Vec3> positions;
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 5; ++j) {
            positions.emplace_back(0.2 * i - 0.4, 0.2 * j - 0.4, i < 2 ? 0.0 : 0.25);
        }
    }
    return test_support::confocal_scan(positions);
}

calib::SceneState bowed_state() {
    calib::SceneState state;
    state.numbers = {{"wall.bow", 0.06}, {"wall.scale", 0.1}};
    return state;
}

TEST(WallMotion, NormalsAreThoseOfTheMovedSurface) {
    constexpr double kStep = 1e-6;
    const core::WallScan scan = stepped_scan();
    const WallMotion motion(scan);
    const calib::SceneState state = bowed_state();
    const auto position = [&](const Vec3& p) -> Vec3 {
        return motion.moved(test_support::wall_points({p}), state)[0].position;
    };
    const std::vector<MovedWallPoint> moved = motion.moved(scan.sensing, state);
    for (std::size_t i = 0; i < moved.size(); ++i) {
        const Vec3& p = scan.sensing.positions[i];
        const Vec3 x = position(p + kStep * Vec3::UnitX()) - position(p - kStep * Vec3::UnitX());
        const Vec3 y = position(p + kStep * Vec3::UnitY()) - position(p - kStep * Vec3::UnitY());
        const Vec3 normal = x.cross(y).normalized();
        EXPECT_LT((moved[i].normal - normal).norm(), 1e-6) << i;
    }
}

TEST(WallMotion, PointsGrowAboutTheCentreAndRiseByTheBow) {
    const core::WallScan scan =
        test_support::confocal_scan({{0.9, 1.0, 0.0}, {1.0, 1.0, 0.0}, {1.1, 1.0, 0.0}});
    const std::vector<MovedWallPoint> moved = WallMotion(scan).moved(scan.sensing, bowed_state());
    const double reach = 0.1 * std::exp(0.1);
    EXPECT_LT((moved[0].position - Vec3(1.0 - reach, 1.0, 0.0)).norm(), 1e-12);
    EXPECT_LT((moved[1].position - Vec3(1.0, 1.0, 0.06)).norm(), 1e-12);
    EXPECT_LT((moved[2].position - Vec3(1.0 + reach, 1.0, 0.0)).norm(), 1e-12);
}

}  // namespace
