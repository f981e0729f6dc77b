// SPDX-License-Identifier: MIT
#include "renderer/core/principal_axes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::Mat3;
using core::Vec3;

TEST(PrincipalAxes, OfABoxOfPointsAreItsOwn) {
    const Vec3 center(0.3, -2.0, 5.0);
    const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
    const Vec3 half(0.2, 3.0, 1.0);
    std::vector<Vec3> corners;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 sign((corner & 1) ? 1.0 : -1.0, (corner & 2) ? 1.0 : -1.0, corner < 4 ? 1 : -1);
        corners.push_back(center + turn * half.cwiseProduct(sign));
    }
    const core::PrincipalAxes principal = core::principal_axes(corners);
    EXPECT_LT((principal.center_m - center).norm(), 1e-14);
    EXPECT_LT((principal.spread_m - Vec3(0.2, 1.0, 3.0)).norm(), 1e-13);
    EXPECT_NEAR(std::abs(principal.axes.col(0).dot(turn.col(0))), 1.0, 1e-13);
    EXPECT_NEAR(std::abs(principal.axes.col(1).dot(turn.col(2))), 1.0, 1e-13);
    EXPECT_NEAR(std::abs(principal.axes.col(2).dot(turn.col(1))), 1.0, 1e-13);
}

TEST(PrincipalAxes, OfFewPointsHaveNoSpread) {
    EXPECT_EQ(core::principal_axes({}).axes, Mat3::Identity());
    const core::PrincipalAxes one = core::principal_axes({Vec3(1.0, 2.0, 3.0)});
    EXPECT_EQ(one.center_m, Vec3(1.0, 2.0, 3.0));
    EXPECT_EQ(one.spread_m, Vec3::Zero());
    const core::PrincipalAxes line = core::principal_axes({Vec3::Zero(), Vec3(0.0, 0.0, 4.0)});
    EXPECT_NEAR(line.spread_m[2], 2.0, 1e-15);
    EXPECT_LT(line.spread_m[1], 1e-15);
}

}  // namespace
