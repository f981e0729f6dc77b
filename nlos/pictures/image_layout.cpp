// SPDX-License-Identifier: MIT
#include "nlos/pictures/image_layout.h"

namespace nlos {

std::array<double, 2> cell_edges(double first, double pitch, std::size_t count) {
    return {first - 0.5 * pitch, first + (static_cast<double>(count) - 0.5) * pitch};
}

std::array<double, 2> cell_edges(const std::vector<double>& centres) {
    if (centres.empty()) return {0.0, 1.0};
    const std::size_t count = centres.size();
    const double pitch =
        count > 1 ? (centres.back() - centres.front()) / static_cast<double>(count - 1) : 1.0;
    return {centres.front() - 0.5 * pitch, centres.back() + 0.5 * pitch};
}

ImagePanel camera_panel(const core::PinholeCamera& camera, const std::vector<float>& of_pixels) {
    ImagePanel panel = image_of(camera.width(), camera.height(), [&](std::size_t x, std::size_t y) {
        return of_pixels[x * camera.height() + y];
    });
    panel.x_range = {0.0, static_cast<double>(panel.width)};
    panel.y_range = {0.0, static_cast<double>(panel.height)};
    panel.x_label = "column [pixel]";
    panel.y_label = "row [pixel]";
    panel.y_direction = AxisDirection::Reversed;
    return panel;
}

ImagePanel wall_panel(const WallGrid& grid, const std::vector<float>& of_points) {
    ImagePanel panel = image_of(grid.size[0], grid.size[1], [&](std::size_t ix, std::size_t iy) {
        return of_points[grid.point(ix, iy)];
    });
    panel.x_range = cell_edges(grid.first_m[0], grid.pitch_m[0], panel.width);
    panel.y_range = cell_edges(grid.first_m[1], grid.pitch_m[1], panel.height);
    panel.x_label = kWallX;
    panel.y_label = kWallY;
    panel.x_direction = AxisDirection::Reversed;
    return panel;
}

bool is_picture(const core::Scan& scan) {
    return scan.visit(
        [](const core::WallScan& wall) { return derive_wall_frame(wall).grid.has_value(); },
        [](const core::ImageScan&) { return true; });
}

}  // namespace nlos
