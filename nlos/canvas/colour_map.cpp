// SPDX-License-Identifier: MIT
#include "nlos/canvas/colour_map.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

using Table = std::array<Colour, 256>;

/// A map of OpenCV, which has those of Matplotlib.
Table opencv_table(cv::ColormapTypes map) {
    cv::Mat_<std::uint8_t> levels(1, 256);
    std::iota(levels.begin(), levels.end(), std::uint8_t{0});
    cv::Mat_<cv::Vec3b> colours;
    cv::applyColorMap(levels, colours, map);
    Table table;
    std::transform(colours.begin(), colours.end(), table.begin(), [](const cv::Vec3b& bgr) {
        return Colour{bgr[2], bgr[1], bgr[0]};
    });
    return table;
}

/// Colours spaced evenly between `anchors`, blended linearly.
template <std::size_t N>
Table blended_table(const std::array<Colour, N>& anchors) {
    Table table;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double position = static_cast<double>(i) / 255.0 * static_cast<double>(N - 1);
        const std::size_t low = std::min(static_cast<std::size_t>(position), N - 2);
        const double weight = position - static_cast<double>(low);
        const auto blend = [&](std::uint8_t a, std::uint8_t b) {
            return static_cast<std::uint8_t>(std::lround((1.0 - weight) * a + weight * b));
        };
        const Colour& a = anchors[low];
        const Colour& b = anchors[low + 1];
        table[i] = {blend(a.red, b.red), blend(a.green, b.green), blend(a.blue, b.blue)};
    }
    return table;
}

/// Blue to white to red; the anchors are the nine-class RdBu scheme of [Harrower2003], reversed.
Table diverging_table() {
    return blended_table<9>({{{33, 102, 172},
                              {67, 147, 195},
                              {146, 197, 222},
                              {209, 229, 240},
                              {255, 255, 255},
                              {253, 219, 199},
                              {244, 165, 130},
                              {214, 96, 77},
                              {178, 24, 43}}});
}

}  // namespace

const std::array<Colour, 256>& colours_of(ColourMap map) {
    static const std::array<Table, 5> tables{// in the order of ColourMap
                                             opencv_table(cv::COLORMAP_INFERNO),
                                             opencv_table(cv::COLORMAP_VIRIDIS),
                                             opencv_table(cv::COLORMAP_CIVIDIS),
                                             diverging_table(),
                                             blended_table<2>({{{0, 0, 0}, {255, 255, 255}}})};
    return tables[static_cast<std::size_t>(map)];
}

Colour colour_at(ColourMap map, double fraction) {
    const double level = fraction > 0.0 ? std::min(fraction, 1.0) * 255.0 : 0.0;  // NaN is dark
    return colours_of(map)[static_cast<std::size_t>(std::lround(level))];
}

}  // namespace nlos
