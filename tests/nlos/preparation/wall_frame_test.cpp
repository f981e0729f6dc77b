// SPDX-License-Identifier: MIT
#include "nlos/preparation/wall_frame.h"

#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

using core::Vec3;
using nlos_test::wall_grid;

core::WallScan scan_of(const core::WallPoints& points) {
    core::WallScan scan;
    scan.sensing = points;
    scan.illumination = points;
    return scan;
}

core::Transform some_pose() {
    core::Transform pose = core::Transform::Identity();
    pose.translate(Vec3(3.0, -2.0, 1.0));
    pose.rotate(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 0.5).normalized()));
    return pose;
}

TEST(WallFrame, RecoversPoseAndPitchOfARotatedGrid) {
    const core::Transform pose = some_pose();
    const WallFrame wall = derive_wall_frame(scan_of(wall_grid({5, 8}, {0.02, 0.03}, pose)));
    ASSERT_TRUE(wall.grid) << wall.why_no_grid;
    EXPECT_LT((wall.world_from_wall.translation() - pose.translation()).norm(), 1e-9);
    EXPECT_TRUE(wall.world_from_wall.linear().isApprox(pose.linear(), 1e-9));
    EXPECT_NEAR(wall.grid->pitch_m[0], 0.02, 1e-12);
    EXPECT_NEAR(wall.grid->pitch_m[1], 0.03, 1e-12);
    EXPECT_NEAR(wall.min_m[0], -0.05, 1e-9);  // half a cell beyond the outermost points
    EXPECT_NEAR(wall.max_m[1], 0.12, 1e-9);
}

TEST(WallFrame, IsDescribedInTheWorld) {
    EXPECT_EQ(describe_wall_frame(core::Transform::Identity()), "the world's");
    core::Transform pose = core::Transform::Identity();
    pose.translate(Vec3(1e-8, -1e-9, 0.0));  // as rounding makes it
    EXPECT_EQ(describe_wall_frame(pose), "the world's");
    pose = Eigen::Translation3d(3.0, 0.0, -1.5) * Eigen::AngleAxisd(core::kPi, Vec3::UnitY());
    EXPECT_EQ(describe_wall_frame(pose),
              "from (3, 0, -1.5) m of the world, wall x along (-1, 0, 0), wall y along (0, 1, 0), "
              "depth along (0, 0, -1)");
}

TEST(WallFrame, CountsUpWhereTheCaptureCountsDown) {
    core::WallPoints points = wall_grid({4, 6}, {0.02, 0.03});
    for (Vec3& position : points.positions) position.y() = -position.y();
    const WallFrame wall = derive_wall_frame(scan_of(points));
    ASSERT_TRUE(wall.grid) << wall.why_no_grid;
    EXPECT_TRUE(wall.world_from_wall.linear().isApprox(core::Mat3::Identity(), 1e-9));
    EXPECT_FALSE(wall.grid->is_descending[0]);
    EXPECT_TRUE(wall.grid->is_descending[1]);
    for (std::size_t ix = 0; ix < 4; ++ix) {
        for (std::size_t iy = 0; iy < 6; ++iy) {
            const Vec3 expected(wall.grid->x_m(ix), wall.grid->y_m(iy), 0.0);
            EXPECT_LT((points.positions[wall.grid->point(ix, iy)] - expected).norm(), 1e-9);
        }
    }
}

TEST(WallFrame, NamesABentWall) {
    core::WallPoints points = wall_grid({6, 6}, {0.02, 0.02});
    for (Vec3& position : points.positions) position.z() = 0.5 * position.x() * position.x();
    const WallFrame wall = derive_wall_frame(scan_of(points));
    EXPECT_FALSE(wall.grid);
    EXPECT_NE(wall.why_no_grid.find("off their plane"), std::string::npos) << wall.why_no_grid;
}

TEST(WallFrame, NamesAnUnevenGrid) {
    core::WallPoints points = wall_grid({6, 6}, {0.02, 0.02});
    points.positions[7].x() += 0.005;
    const WallFrame wall = derive_wall_frame(scan_of(points));
    EXPECT_FALSE(wall.grid);
    EXPECT_NE(wall.why_no_grid.find("even"), std::string::npos) << wall.why_no_grid;
}

TEST(WallFrame, FindsThePlaneOfAList) {
    const core::Transform pose = some_pose();
    core::WallPoints points = wall_grid({5, 8}, {0.02, 0.03}, pose);
    points.grid.reset();
    const WallFrame wall = derive_wall_frame(scan_of(points));
    EXPECT_FALSE(wall.grid);
    EXPECT_TRUE(wall.world_from_wall.linear().col(2).isApprox(pose.linear().col(2), 1e-9));
    EXPECT_NEAR(wall.world_from_wall.linear().determinant(), 1.0, 1e-9);
}

TEST(WallFrame, SurvivesASinglePoint) {
    const WallFrame wall = derive_wall_frame(scan_of(wall_grid({1, 1}, {0.02, 0.02})));
    EXPECT_FALSE(wall.grid);
    EXPECT_TRUE(wall.world_from_wall.matrix().allFinite());
    EXPECT_TRUE(wall.world_from_wall.linear().col(2).isApprox(Vec3::UnitZ()));
}

}  // namespace
}  // namespace nlos
