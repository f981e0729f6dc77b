// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace calib {

/// Chessboards photographed by a camera that also sees the wall.
struct BoardSettings {
    std::vector<std::string> images;
    std::array<int, 2> inner_corners{9, 6};
    double square_m = 0.025;
    int wall_image = 0;  ///< which image shows the board lying on the wall
};

template <class Visitor>
void for_each_field(BoardSettings& s, Visitor&& visit) {
    visit("images", s.images, "PNG or JPEG photographs of the board in several poses");
    visit("inner_corners",
          s.inner_corners,
          core::at_least(3, "corners between four squares, per row and per column"));
    visit("square_m", s.square_m, core::above(0, "edge of a square [m]"));
    visit("wall_image",
          s.wall_image,
          core::at_least(0, "the image whose board lies on the wall, from 0"));
}

/// A pinhole camera with two radial distortion terms; world is the wall's frame.
struct CameraCalibration {
    double focal_x_px = 0.0;
    double focal_y_px = 0.0;
    double center_x_px = 0.0;
    double center_y_px = 0.0;
    std::array<double, 2> radial{};
    std::array<double, 4> sigma_px{};  ///< of the four above
    double reprojection_rms_px = 0.0;
    core::Transform camera_from_wall = core::Transform::Identity();
    core::Mat3 wall_from_pixel = core::Mat3::Identity();  ///< homography, distortion removed first

    /// Wall point (x, y) seen at a pixel [m].
    core::Vec2 wall_point(const core::Vec2& pixel) const;
    /// Pixel at which a wall point is seen, for numbers or automatic derivatives.
    template <class T = double>
    Eigen::Matrix<T, 2, 1> project(const Eigen::Matrix<T, 3, 1>& wall_point) const {
        const Eigen::Matrix<T, 3, 1> seen = camera_from_wall.linear().cast<T>() * wall_point +
                                            camera_from_wall.translation().cast<T>();
        const T x = seen[0] / seen[2];
        const T y = seen[1] / seen[2];
        const T r2 = x * x + y * y;
        const T bend = 1.0 + radial[0] * r2 + radial[1] * r2 * r2;
        return {T(focal_x_px * bend * x + center_x_px), T(focal_y_px * bend * y + center_y_px)};
    }
};

/// Finds the boards, calibrates the camera, and places the wall.
///
/// The wall's frame: origin at the board's first inner corner, x along its rows, normal towards the
/// camera. Of a board with an odd and an even number of inner corners, the first corner is the one
/// at a dark outer square; with others it may be either end, so avoid those.
///
/// images    PNG or JPEG photographs of one size (read_photograph)
/// throws    core::Error naming an image that cannot be read or shows no board
/// source    [Zhang2000] as OpenCV implements it
CameraCalibration calibrate_camera(const BoardSettings& settings);

/// A grey picture on the sensor's own grid of pixels, row by row from the top.
struct Photograph {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> grey;
};

/// Reads a PNG or JPEG file, of grey or colour, of 8 or 16 bits; alpha is ignored.
///
/// throws    core::Error for other and damaged files, and for those with an EXIF orientation: a
///           camera is calibrated on its sensor's own grid, which turned views would mix up, while
///           many programs show, and count pixels in, the turned picture
Photograph read_photograph(const std::string& path);

}  // namespace calib
