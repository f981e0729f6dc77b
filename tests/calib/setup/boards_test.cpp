// SPDX-License-Identifier: MIT
// Drawn photographs of a chessboard: the camera they give, and what it adds to direct returns.
#include "calib/setup/boards.h"

#include "calib/calibrate.h"
#include "tests/calib/setup/simulated_setup.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <random>

namespace {

using core::Vec2;
using core::Vec3;
using setup_test::command_grid;
using setup_test::Device;
using setup_test::direct_returns;
using setup_test::ranges_of;
using setup_test::setup_of;
using setup_test::spot_of;

// A camera that looks at the wall from the device's side.
struct DrawnCamera {
    cv::Mat intrinsics = (cv::Mat_<double>(3, 3) << 1000, 0, 490, 0, 1010, 350, 0, 0, 1);
    cv::Size size{960, 720};
};

// A chessboard of 9 x 6 inner corners seen under a rotation and translation, with sensor noise.
void draw_board(const DrawnCamera& camera,
                const cv::Vec3d& rotation,
                const cv::Vec3d& translation,
                double square_m,
                const std::string& path,
                unsigned seed) {
    constexpr int kCell = 60;
    cv::Mat flat(9 * kCell, 12 * kCell, CV_8U, cv::Scalar(255));
    for (int j = 0; j < 7; ++j) {
        for (int i = 0; i < 10; ++i) {
            if ((i + j) % 2 != 0) continue;
            cv::rectangle(flat,
                          cv::Rect((i + 1) * kCell, (j + 1) * kCell, kCell, kCell),
                          cv::Scalar(0),
                          cv::FILLED);
        }
    }
    // Pixel centres are whole numbers: the first inner corner lies between pixels.
    cv::Mat board_from_flat = (cv::Mat_<double>(3, 3) << square_m / kCell,
                               0,
                               -square_m * (2.0 - 0.5 / kCell),
                               0,
                               square_m / kCell,
                               -square_m * (2.0 - 0.5 / kCell),
                               0,
                               0,
                               1);
    cv::Mat turn;
    cv::Rodrigues(rotation, turn);
    cv::Mat pose(3, 3, CV_64F);
    turn.col(0).copyTo(pose.col(0));
    turn.col(1).copyTo(pose.col(1));
    cv::Mat(translation).copyTo(pose.col(2));
    const cv::Mat map = camera.intrinsics * pose * board_from_flat;
    constexpr int kFiner = 3;  // drawn finer and averaged, so that edges are smooth
    const double offset = (kFiner - 1) / 2.0;
    const cv::Mat finer = (cv::Mat_<double>(3, 3) << kFiner, 0, offset, 0, kFiner, offset, 0, 0, 1);
    cv::Mat large;
    cv::warpPerspective(flat,
                        large,
                        finer * map,
                        camera.size * kFiner,
                        cv::INTER_LINEAR,
                        cv::BORDER_CONSTANT,
                        cv::Scalar(180));
    cv::Mat image;
    cv::resize(large, image, camera.size, 0, 0, cv::INTER_AREA);
    cv::Mat noise(image.size(), CV_16S);
    cv::RNG generator(seed);
    generator.fill(noise, cv::RNG::NORMAL, 0, 4);
    image.convertTo(image, CV_16S);
    image += noise;
    image.convertTo(image, CV_8U);
    cv::imwrite(path, image);
}

struct DrawnBoards {
    test_support::TemporaryFolder folder;
    calib::BoardSettings settings;
    DrawnCamera camera;
    cv::Vec3d wall_rotation{0.25, -0.2, 0.05};
    cv::Vec3d wall_translation{-0.35, -0.2, 1.6};

    DrawnBoards() {
        settings.square_m = 0.08;
        std::mt19937_64 engine(test_support::seed_of("DrawnBoards"));
        std::uniform_real_distribution<double> any(-1.0, 1.0);
        for (int i = 0; i < 9; ++i) {
            cv::Vec3d rotation{0.5 * any(engine), 0.5 * any(engine), 0.3 * any(engine)};
            cv::Vec3d translation{
                -0.35 + 0.15 * any(engine), -0.2 + 0.1 * any(engine), 1.5 + 0.2 * any(engine)};
            if (i == 0) {
                rotation = wall_rotation;
                translation = wall_translation;
            }
            settings.images.push_back(folder.file("board" + std::to_string(i) + ".png"));
            draw_board(camera,
                       rotation,
                       translation,
                       settings.square_m,
                       settings.images.back(),
                       static_cast<unsigned>(i + 1));
        }
    }

    // Wall's frame: x along the rows, y against the columns.
    Vec2 pixel_of(const Vec3& wall) const {
        std::vector<cv::Point2d> pixels;
        cv::projectPoints(std::vector<cv::Point3d>{{wall.x(), -wall.y(), -wall.z()}},
                          wall_rotation,
                          wall_translation,
                          camera.intrinsics,
                          cv::noArray(),
                          pixels);
        return {pixels[0].x, pixels[0].y};
    }
};

TEST(Boards, FocalLengthAndHomographyComeBack) {
    const DrawnBoards drawn;
    const calib::CameraCalibration camera = calib::calibrate_camera(drawn.settings);
    EXPECT_NEAR(camera.focal_x_px, 1000.0, 0.005 * 1000.0);
    EXPECT_NEAR(camera.focal_y_px, 1010.0, 0.005 * 1010.0);
    for (const double x : {0.0, 0.3, 0.6}) {
        for (const double y : {0.0, -0.2, -0.4}) {
            const Vec3 wall(x, y, 0.0);
            const Vec2 pixel = drawn.pixel_of(wall);
            EXPECT_LT((camera.project(wall) - pixel).norm(), 0.3);
            const Vec2 back = camera.wall_point(pixel);
            EXPECT_LT((camera.project(Vec3(back.x(), back.y(), 0.0)) - pixel).norm(), 0.01);
            EXPECT_LT((back - wall.head<2>()).norm(), 4e-4);
        }
    }
}

TEST(Boards, CameraResolvesWhatDirectReturnsCannot) {
    const DrawnBoards drawn;
    Device device;
    device.distance_m = 2.0;
    device.gain = 0.1;
    const auto commands = command_grid(8, 1.5);
    const auto capture = direct_returns(ranges_of(device, commands), 1000.0, 0.0, "Camera");
    calib::SetupSettings settings = setup_of(commands);
    settings.command_unit = calib::CommandUnit::Volt;
    settings.boards = drawn.settings;
    std::mt19937_64 engine(test_support::seed_of("CameraSpots"));
    std::normal_distribution<double> noise(0.0, 0.1);
    const Vec3 foot(0.32, -0.2, 0.0);
    for (const auto& command : commands) {
        const Vec2 pixel = drawn.pixel_of(spot_of(device, command) + foot);
        settings.spots_px.push_back({pixel.x() + noise(engine), pixel.y() + noise(engine)});
    }
    const calib::Calibration result = calib::calibrate(settings, capture);
    EXPECT_NEAR(result.setup.values[7], 0.1, 0.005 * 0.1);
    EXPECT_NEAR(result.setup.values[0], 2.0, 0.02);
    double squared = 0.0;
    for (std::size_t i = 0; i < commands.size(); ++i) {
        squared += (result.setup.points_m[i] - foot - spot_of(device, commands[i])).squaredNorm();
    }
    EXPECT_LT(std::sqrt(squared / static_cast<double>(commands.size())), 0.001);
}

}  // namespace
