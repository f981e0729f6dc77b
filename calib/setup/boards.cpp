// SPDX-License-Identifier: MIT
#include "calib/setup/boards.h"

#include "renderer/core/error.h"

#include <Eigen/Dense>
#include <fmt/core.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace calib {
namespace {

using core::Vec2;
using core::Vec3;

// Brightness in the middle of the square whose first corner has this index.
double square_brightness(const cv::Mat& image,
                         const std::vector<cv::Point2f>& corners,
                         std::size_t index,
                         std::size_t columns) {
    const cv::Point2f middle = 0.25F * (corners[index] + corners[index + 1] +
                                        corners[index + columns] + corners[index + columns + 1]);
    cv::Mat patch;
    cv::getRectSubPix(image, cv::Size(3, 3), middle, patch);
    return cv::mean(patch)[0];
}

// The detector may start at either end of the board. Where the two ends differ in colour, the dark
// one comes first.
void start_at_dark_end(const cv::Mat& image,
                       const cv::Size& inner,
                       std::vector<cv::Point2f>& corners) {
    if ((inner.width + inner.height) % 2 == 0) return;
    const auto columns = static_cast<std::size_t>(inner.width);
    const double first = square_brightness(image, corners, 0, columns);
    const double last = square_brightness(image, corners, corners.size() - columns - 2, columns);
    if (first > last) std::reverse(corners.begin(), corners.end());
}

std::vector<cv::Point2f> find_corners(const std::string& path,
                                      const cv::Size& inner,
                                      cv::Size& image_size) {
    Photograph photograph = read_photograph(path);
    const cv::Mat image(photograph.height, photograph.width, CV_8UC1, photograph.grey.data());
    if (image_size.area() > 0 && image.size() != image_size) {
        throw core::Error(path,
                          fmt::format("has {} x {} pixels", image.cols, image.rows),
                          fmt::format("must have {} x {}", image_size.width, image_size.height));
    }
    image_size = image.size();
    std::vector<cv::Point2f> corners;
    if (!cv::findChessboardCornersSB(image, inner, corners, cv::CALIB_CB_ACCURACY)) {
        throw core::Error(
            path,
            "shows no whole chessboard",
            fmt::format("must show one of {} x {} inner corners", inner.width, inner.height));
    }
    start_at_dark_end(image, inner, corners);
    return corners;
}

core::Mat3 intrinsics_of(const CameraCalibration& camera) {
    core::Mat3 matrix;
    matrix << camera.focal_x_px, 0.0, camera.center_x_px,  //
        0.0, camera.focal_y_px, camera.center_y_px,        //
        0.0, 0.0, 1.0;
    return matrix;
}

cv::Mat distortion_of(const CameraCalibration& camera) {
    return (cv::Mat_<double>(1, 4) << camera.radial[0], camera.radial[1], 0.0, 0.0);
}

// The board's z runs away from the camera and its y downwards; the wall's do not.
core::Transform camera_from_wall(const cv::Mat& rotation_vector, const cv::Mat& translation) {
    cv::Mat rotation;
    cv::Rodrigues(rotation_vector, rotation);
    core::Mat3 camera_from_board;
    cv::cv2eigen(rotation, camera_from_board);
    Vec3 board_origin;
    cv::cv2eigen(translation, board_origin);
    core::Transform result = core::Transform::Identity();
    result.linear() = camera_from_board * Vec3(1.0, -1.0, -1.0).asDiagonal();
    result.translation() = board_origin;
    return result;
}

// Inner corners of the board in its own frame, row by row [m].
std::vector<cv::Point3f> board_points(const cv::Size& inner, double square_m) {
    std::vector<cv::Point3f> points;
    for (int j = 0; j < inner.height; ++j) {
        for (int i = 0; i < inner.width; ++i) {
            points.emplace_back(
                static_cast<float>(i * square_m), static_cast<float>(j * square_m), 0.0F);
        }
    }
    return points;
}

void check(const BoardSettings& settings) {
    const std::size_t count = settings.images.size();
    if (count < 3) {
        throw core::Error("boards.images",
                          fmt::format("found {} images", count),
                          "a camera needs at least 3 views of the board, tilted differently");
    }
    if (settings.wall_image >= static_cast<int>(count)) {
        throw core::Error("boards.wall_image",
                          fmt::format("found {}", settings.wall_image),
                          fmt::format("must be from 0 to {}", count - 1));
    }
}

// The camera, but for where it stands; where every image's board stands before it.
struct SolvedCamera {
    CameraCalibration camera;
    std::vector<cv::Mat> rotations;
    std::vector<cv::Mat> translations;
};

SolvedCamera solve_camera(const std::vector<std::vector<cv::Point2f>>& corners,
                          const std::vector<cv::Point3f>& board,
                          const cv::Size& size) {
    cv::Mat intrinsics;
    cv::Mat distortion;
    cv::Mat sigma;
    SolvedCamera solved;
    CameraCalibration& camera = solved.camera;
    camera.reprojection_rms_px =
        cv::calibrateCamera(std::vector(corners.size(), board),
                            corners,
                            size,
                            intrinsics,
                            distortion,
                            solved.rotations,
                            solved.translations,
                            sigma,
                            cv::noArray(),
                            cv::noArray(),
                            cv::CALIB_ZERO_TANGENT_DIST | cv::CALIB_FIX_K3);
    camera.focal_x_px = intrinsics.at<double>(0, 0);
    camera.focal_y_px = intrinsics.at<double>(1, 1);
    camera.center_x_px = intrinsics.at<double>(0, 2);
    camera.center_y_px = intrinsics.at<double>(1, 2);
    camera.radial = {distortion.at<double>(0), distortion.at<double>(1)};
    for (int i = 0; i < 4; ++i) {
        camera.sigma_px[static_cast<std::size_t>(i)] = sigma.at<double>(i);
    }
    return solved;
}

// A wall point (x, y, 0) is seen at K (x r_x + y r_y + t).
core::Mat3 wall_from_pixel(const CameraCalibration& camera) {
    core::Mat3 pixel_from_wall;
    pixel_from_wall << camera.camera_from_wall.linear().col(0),
        camera.camera_from_wall.linear().col(1), camera.camera_from_wall.translation();
    return (intrinsics_of(camera) * pixel_from_wall).inverse();
}

}  // namespace

Vec2 CameraCalibration::wall_point(const Vec2& pixel) const {
    const std::vector<cv::Point2d> distorted{{pixel.x(), pixel.y()}};
    std::vector<cv::Point2d> straight;
    cv::Mat intrinsics;
    cv::eigen2cv(intrinsics_of(*this), intrinsics);
    cv::undistortPoints(
        distorted, straight, intrinsics, distortion_of(*this), cv::noArray(), intrinsics);
    const Vec3 p = wall_from_pixel * Vec3(straight[0].x, straight[0].y, 1.0);
    return p.head<2>() / p.z();
}

CameraCalibration calibrate_camera(const BoardSettings& settings) {
    check(settings);
    const cv::Size inner(settings.inner_corners[0], settings.inner_corners[1]);
    cv::Size size;
    std::vector<std::vector<cv::Point2f>> corners;
    for (const std::string& path : settings.images) {
        corners.push_back(find_corners(path, inner, size));
    }
    const auto [solved, rotations, translations] =
        solve_camera(corners, board_points(inner, settings.square_m), size);
    CameraCalibration camera = solved;
    const auto wall = static_cast<std::size_t>(settings.wall_image);
    camera.camera_from_wall = camera_from_wall(rotations[wall], translations[wall]);
    camera.wall_from_pixel = wall_from_pixel(camera);
    return camera;
}

}  // namespace calib
