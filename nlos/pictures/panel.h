// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/canvas/colour_map.h"
#include "nlos/plots/plot.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace nlos {

/// Labels of axes in the wall's frame; x, y and z alone are the world's (nlos/formats/README.md).
inline constexpr const char* kWallX = "wall x [m]";
inline constexpr const char* kWallY = "wall y [m]";
inline constexpr const char* kWallDepth = "depth from the wall [m]";

/// How an axis runs in the picture. Usual: x to the right, y upwards.
enum class AxisDirection { Usual, Reversed };

/// Whether a metre is as long along x as along y.
enum class AspectRatio { Equal, Free };

/// How values become colours. Gamma: by their square root above the lower end, which shows what is
/// far below the brightest; the colour bar's ticks say so.
enum class ValueScale { Linear, Gamma };

/// Values on a regular grid, drawn as colours with axes and a colour bar.
struct ImagePanel {
    std::string title;
    std::size_t width = 0;      ///< values along x
    std::size_t height = 0;     ///< values along y
    std::vector<float> values;  ///< stored [y][x], x fastest; NaN is drawn as background
    std::array<double, 2> x_range{0.0, 1.0};  ///< outer edges of the first and last value
    std::array<double, 2> y_range{0.0, 1.0};
    std::string x_label;  ///< with unit: "path length [m]"
    std::string y_label;
    std::string value_label;  ///< beside the colour bar, with unit
    ColourMap colour_map = ColourMap::Inferno;
    AxisDirection x_direction = AxisDirection::Usual;
    AxisDirection y_direction = AxisDirection::Usual;
    AspectRatio aspect = AspectRatio::Equal;
    /// Of equal axes: the length that a plot of the usual size stands for, so that panels beside
    /// each other share a scale; 0: the longer axis.
    double full_length = 0.0;
    ValueScale value_scale = ValueScale::Linear;
    std::optional<std::array<double, 2>> value_range;  ///< empty: from the values
    /// What the values 1, 2, ... stand for, 0 being nothing: a legend in place of the colour bar.
    std::vector<std::pair<std::string, Colour>> categories;
};

/// An image of `width` x `height` values value_of(ix, iy).
template <class ValueOf>
ImagePanel image_of(std::size_t width, std::size_t height, const ValueOf& value_of) {
    ImagePanel panel;
    panel.width = width;
    panel.height = height;
    panel.values.reserve(width * height);
    for (std::size_t iy = 0; iy < height; ++iy) {
        for (std::size_t ix = 0; ix < width; ++ix) {
            panel.values.push_back(static_cast<float>(value_of(ix, iy)));
        }
    }
    return panel;
}

/// A line of a drawing; with `fill` its inside is coloured too.
struct DrawnLine {
    std::vector<std::array<double, 2>> points;  ///< (x, y) in the units of the axes
    Colour colour;
    int thickness_px = 3;
    double fill = 0.0;  ///< opacity of the inside, in [0, 1]
};

/// Lines on axes of one scale, such as a plan, with a legend beside them.
struct DrawingPanel {
    std::string title;
    std::vector<DrawnLine> lines;  ///< later ones above earlier ones
    std::vector<std::pair<std::string, Colour>> legend;
    std::array<double, 2> x_range{0.0, 1.0};
    std::array<double, 2> y_range{0.0, 1.0};
    std::string x_label;  ///< with unit
    std::string y_label;
};

using Panel = std::variant<ImagePanel, Plot, DrawingPanel>;

}  // namespace nlos
