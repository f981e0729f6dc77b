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
    ImagePanel panel;
    panel.width = camera.width();
    panel.height = camera.height();
    for (std::size_t y = 0; y < panel.height; ++y) {
        for (std::size_t x = 0; x < panel.width; ++x) {
            panel.values.push_back(of_pixels[x * panel.height + y]);
        }
    }
    panel.x_range = {0.0, static_cast<double>(panel.width)};
    panel.y_range = {0.0, static_cast<double>(panel.height)};
    panel.x_label = "x [pixel]";
    panel.y_label = "y [pixel]";
    panel.y_direction = AxisDirection::Reversed;
    return panel;
}

ImagePanel wall_panel(const WallGrid& grid, const std::vector<float>& of_points) {
    ImagePanel panel;
    panel.width = grid.size[0];
    panel.height = grid.size[1];
    for (std::size_t iy = 0; iy < panel.height; ++iy) {
        for (std::size_t ix = 0; ix < panel.width; ++ix) {
            panel.values.push_back(of_points[grid.point(ix, iy)]);
        }
    }
    panel.x_range = cell_edges(grid.first_m[0], grid.pitch_m[0], panel.width);
    panel.y_range = cell_edges(grid.first_m[1], grid.pitch_m[1], panel.height);
    panel.x_label = "wall x [m]";
    panel.y_label = "wall y [m]";
    panel.x_direction = AxisDirection::Reversed;
    return panel;
}

}  // namespace nlos
