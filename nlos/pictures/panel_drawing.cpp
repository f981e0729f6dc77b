// SPDX-License-Identifier: MIT
#include "nlos/pictures/panel_drawing.h"

#include "nlos/pictures/axis_ticks.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

// Sizes in pixels of the file, which has two for each pixel of an ordinary screen.
constexpr int kPlotSize = 640;      // longer side of a plot
constexpr int kSmallestSide = 200;  // of a plot much longer than wide
constexpr int kTitleHeight = 66;
constexpr int kLeftMargin = 132;    // y label and tick labels
constexpr int kBottomMargin = 108;  // tick labels and x label
constexpr int kBarGap = 28;
constexpr int kBarWidth = 22;
constexpr int kBarLabels = 132;
constexpr int kLegendLine = 44;
constexpr int kLegendStep = 40;
constexpr int kPanelGap = 44;  // to the next panel
constexpr int kTickLength = 9;
constexpr int kLine = 2;

constexpr Colour kInk{32, 36, 44};
constexpr Colour kSoftInk{92, 98, 108};
constexpr Colour kAxis{120, 126, 136};
constexpr Colour kGrid{228, 231, 235};
constexpr Colour kNoValue{214, 217, 222};
constexpr Colour kCurve{37, 99, 180};

const TextStyle kTitleText{19.0, 2.7, kInk, TextAnchor::Start, TextDirection::Horizontal};
const TextStyle kTickText{15.0, 1.8, kSoftInk, TextAnchor::Centre, TextDirection::Horizontal};
const TextStyle kLabelText{16.0, 1.9, kInk, TextAnchor::Centre, TextDirection::Horizontal};

TextStyle anchored(TextStyle style, TextAnchor anchor) {
    style.anchor = anchor;
    return style;
}

TextStyle upwards(TextStyle style) {
    style.direction = TextDirection::Upwards;
    return style;
}

/// One axis of a plot: from value to pixel.
struct PixelAxis {
    double low = 0.0;
    double high = 1.0;
    int low_px = 0;
    int high_px = 1;

    double pixel(double value) const {
        return low_px + (value - low) / (high - low) * (high_px - low_px);
    }
};

PixelAxis pixel_axis(const std::array<double, 2>& range,
                     AxisDirection direction,
                     int begin_px,
                     int end_px) {
    if (direction == AxisDirection::Reversed) std::swap(begin_px, end_px);
    return {range[0], range[1], begin_px, end_px};
}

int tick_count(int length_px) {
    return std::clamp(length_px / 75, 3, 9);
}

// ---- Sizes -------------------------------------------------------------------------------------

PixelSize plot_size(const ImagePanel& panel) {
    if (panel.scale == AxisScale::Free) return {kPlotSize, kPlotSize};
    const double width = std::abs(panel.x_range[1] - panel.x_range[0]);
    const double height = std::abs(panel.y_range[1] - panel.y_range[0]);
    const double scale = kPlotSize / std::max(width, height);
    const auto side = [&](double length) {
        return std::max(kSmallestSide, static_cast<int>(std::lround(length * scale)));
    };
    return {side(width), side(height)};
}

PixelSize plot_size(const DrawingPanel& panel) {
    const double width = std::abs(panel.x_range[1] - panel.x_range[0]);
    const double height = std::abs(panel.y_range[1] - panel.y_range[0]);
    const double scale = kPlotSize / std::max(width, height);
    return {static_cast<int>(std::lround(width * scale)),
            static_cast<int>(std::lround(height * scale))};
}

PixelSize plot_size(const CurvePanel&) {
    return {kPlotSize, kPlotSize};
}

int right_margin(const ImagePanel&) {
    return kBarGap + kBarWidth + kBarLabels + kPanelGap;
}
int right_margin(const CurvePanel&) {
    return kPanelGap;
}
int right_margin(const DrawingPanel& panel) {
    int widest = 0;
    for (const auto& [name, colour] : panel.legend) {
        widest = std::max(widest, Canvas::text_length(name, kTickText));
    }
    return kBarGap + kLegendLine + widest + kPanelGap;
}

void check(const ImagePanel& panel) {
    if (panel.width > 0 && panel.values.size() == panel.width * panel.height) return;
    throw core::Error(
        "picture '" + panel.title + "'",
        fmt::format("found {} values for {} x {}", panel.values.size(), panel.width, panel.height),
        "must be one value per pixel and at least one");
}

void check(const CurvePanel& panel) {
    if (!panel.x.empty() && panel.x.size() == panel.y.size()) return;
    throw core::Error("picture '" + panel.title + "'",
                      fmt::format("found {} x and {} y", panel.x.size(), panel.y.size()),
                      "must be as many, and at least one");
}

void check(const DrawingPanel& panel) {
    if (panel.x_range[1] > panel.x_range[0] && panel.y_range[1] > panel.y_range[0]) return;
    throw core::Error("picture '" + panel.title + "'",
                      fmt::format("found axes from {} to {} and {} to {}",
                                  panel.x_range[0],
                                  panel.x_range[1],
                                  panel.y_range[0],
                                  panel.y_range[1]),
                      "must be ascending");
}

// ---- Axes --------------------------------------------------------------------------------------

void draw_x_axis(Canvas& canvas,
                 const PixelBox& plot,
                 const PixelAxis& axis,
                 const std::string& label) {
    const AxisTicks ticks = choose_ticks(axis.low, axis.high, tick_count(plot.width));
    for (std::size_t i = 0; i < ticks.values.size(); ++i) {
        const int x = static_cast<int>(std::lround(axis.pixel(ticks.values[i])));
        canvas.fill({x - kLine / 2, plot.bottom() + kLine, kLine, kTickLength}, kAxis);
        canvas.text(x, plot.bottom() + 32, ticks.labels[i], kTickText);
    }
    canvas.text(plot.x + plot.width / 2,
                plot.bottom() + 76,
                label_with_exponent(label, ticks.exponent),
                kLabelText);
}

void draw_y_axis(Canvas& canvas,
                 const PixelBox& plot,
                 const PixelAxis& axis,
                 const std::string& label) {
    const AxisTicks ticks = choose_ticks(axis.low, axis.high, tick_count(plot.height));
    for (std::size_t i = 0; i < ticks.values.size(); ++i) {
        const int y = static_cast<int>(std::lround(axis.pixel(ticks.values[i])));
        canvas.fill({plot.x - kLine - kTickLength, y - kLine / 2, kTickLength, kLine}, kAxis);
        canvas.text(plot.x - 20, y, ticks.labels[i], anchored(kTickText, TextAnchor::End));
    }
    canvas.text(plot.x - kLeftMargin + 24,
                plot.y + plot.height / 2,
                label_with_exponent(label, ticks.exponent),
                upwards(kLabelText));
}

// ---- Images ------------------------------------------------------------------------------------

/// The range colours span: given, or that of the finite values, never empty.
std::array<double, 2> value_range(const ImagePanel& panel) {
    if (panel.value_range && (*panel.value_range)[1] > (*panel.value_range)[0]) {
        return *panel.value_range;
    }
    double low = INFINITY;
    double high = -INFINITY;
    for (const float value : panel.values) {
        if (!std::isfinite(value)) continue;
        low = std::min(low, static_cast<double>(value));
        high = std::max(high, static_cast<double>(value));
    }
    if (high > low) return {low, high};
    return low <= high ? std::array{low - 0.5, low + 0.5} : std::array{0.0, 1.0};
}

/// Place of a value on the colour map, 0 to 1 within the range.
double colour_share(const ImagePanel& panel, const std::array<double, 2>& range, double value) {
    const double share = (value - range[0]) / (range[1] - range[0]);
    return panel.value_scale == ValueScale::Gamma ? std::sqrt(std::max(0.0, share)) : share;
}

/// Colours in the order of drawing: rows from the top, columns from the left.
std::vector<Colour> panel_colours(const ImagePanel& panel, const std::array<double, 2>& range) {
    std::vector<Colour> colours;
    colours.reserve(panel.values.size());
    const bool leftwards = panel.x_direction == AxisDirection::Reversed;
    const bool upward = panel.y_direction == AxisDirection::Usual;
    for (std::size_t row = 0; row < panel.height; ++row) {
        const std::size_t iy = upward ? panel.height - 1 - row : row;
        for (std::size_t column = 0; column < panel.width; ++column) {
            const std::size_t ix = leftwards ? panel.width - 1 - column : column;
            const float value = panel.values[iy * panel.width + ix];
            colours.push_back(
                std::isfinite(value)
                    ? colour_at(panel.colour_map, colour_share(panel, range, double{value}))
                    : kNoValue);
        }
    }
    return colours;
}

void draw_colour_bar(Canvas& canvas,
                     const PixelBox& plot,
                     const ImagePanel& panel,
                     const std::array<double, 2>& range) {
    const PixelBox bar{plot.right() + kBarGap, plot.y, kBarWidth, plot.height};
    const auto& table = colours_of(panel.colour_map);
    canvas.image(bar, 1, static_cast<int>(table.size()), {table.rbegin(), table.rend()});
    canvas.frame(bar, kAxis, kLine);

    const PixelAxis axis{0.0, 1.0, bar.bottom(), bar.y};
    const AxisTicks ticks = choose_ticks(range[0], range[1], tick_count(bar.height));
    for (std::size_t i = 0; i < ticks.values.size(); ++i) {
        const int y =
            static_cast<int>(std::lround(axis.pixel(colour_share(panel, range, ticks.values[i]))));
        canvas.fill({bar.right() + kLine, y - kLine / 2, kTickLength, kLine}, kAxis);
        canvas.text(bar.right() + 18, y, ticks.labels[i], anchored(kTickText, TextAnchor::Start));
    }
    canvas.text(bar.right() + kBarLabels - 16,
                bar.y + bar.height / 2,
                label_with_exponent(panel.value_label, ticks.exponent) +
                    (panel.value_scale == ValueScale::Gamma ? ", square-root scale" : ""),
                upwards(kLabelText));
}

void draw_plot(Canvas& canvas, const PixelBox& plot, const ImagePanel& panel) {
    const std::array<double, 2> range = value_range(panel);
    canvas.image(plot,
                 static_cast<int>(panel.width),
                 static_cast<int>(panel.height),
                 panel_colours(panel, range));
    canvas.frame(plot, kAxis, kLine);
    draw_x_axis(canvas,
                plot,
                pixel_axis(panel.x_range, panel.x_direction, plot.x, plot.right()),
                panel.x_label);
    draw_y_axis(canvas,
                plot,
                pixel_axis(panel.y_range, panel.y_direction, plot.bottom(), plot.y),
                panel.y_label);
    draw_colour_bar(canvas, plot, panel, range);
}

// ---- Curves ------------------------------------------------------------------------------------

void draw_grid(Canvas& canvas, const PixelBox& plot, const PixelAxis& x, const PixelAxis& y) {
    for (const double value : choose_ticks(x.low, x.high, tick_count(plot.width)).values) {
        const int px = static_cast<int>(std::lround(x.pixel(value)));
        canvas.fill({px - kLine / 2, plot.y, kLine, plot.height}, kGrid);
    }
    for (const double value : choose_ticks(y.low, y.high, tick_count(plot.height)).values) {
        const int py = static_cast<int>(std::lround(y.pixel(value)));
        canvas.fill({plot.x, py - kLine / 2, plot.width, kLine}, kGrid);
    }
}

void draw_plot(Canvas& canvas, const PixelBox& plot, const CurvePanel& panel) {
    const auto [x_low, x_high] = std::minmax_element(panel.x.begin(), panel.x.end());
    const auto [y_low, y_high] = std::minmax_element(panel.y.begin(), panel.y.end());
    const double bottom = std::min(0.0, *y_low);
    const double top = *y_high > bottom ? *y_high + 0.05 * (*y_high - bottom) : bottom + 1.0;
    const double right = *x_high > *x_low ? *x_high : *x_low + 1.0;
    const PixelAxis x{*x_low, right, plot.x, plot.right()};
    const PixelAxis y{bottom, top, plot.bottom(), plot.y};

    std::vector<std::array<double, 2>> line;
    for (std::size_t i = 0; i < panel.x.size(); ++i) {
        line.push_back({x.pixel(panel.x[i]), y.pixel(panel.y[i])});
    }
    std::vector<std::array<double, 2>> area = line;
    area.push_back({line.back()[0], y.pixel(0.0)});
    area.push_back({line.front()[0], y.pixel(0.0)});
    draw_grid(canvas, plot, x, y);
    canvas.fill_polygon(area, kCurve, 0.15);
    canvas.polyline(line, kCurve, 4);
    canvas.frame(plot, kAxis, kLine);
    draw_x_axis(canvas, plot, x, panel.x_label);
    draw_y_axis(canvas, plot, y, panel.y_label);
}

// ---- Drawings ----------------------------------------------------------------------------------

void draw_plot(Canvas& canvas, const PixelBox& plot, const DrawingPanel& panel) {
    const PixelAxis x{panel.x_range[0], panel.x_range[1], plot.x, plot.right()};
    const PixelAxis y{panel.y_range[0], panel.y_range[1], plot.bottom(), plot.y};
    draw_grid(canvas, plot, x, y);
    for (const DrawnLine& line : panel.lines) {
        std::vector<std::array<double, 2>> points;
        for (const auto& [px, py] : line.points) {
            points.push_back({std::clamp(x.pixel(px), double(plot.x), double(plot.right())),
                              std::clamp(y.pixel(py), double(plot.y), double(plot.bottom()))});
        }
        if (line.fill > 0.0 && points.size() > 2) {
            canvas.fill_polygon(points, line.colour, line.fill);
        }
        if (points.size() > 1 && line.thickness_px > 0) {
            canvas.polyline(points, line.colour, line.thickness_px);
        }
    }
    canvas.frame(plot, kAxis, kLine);
    draw_x_axis(canvas, plot, x, panel.x_label);
    draw_y_axis(canvas, plot, y, panel.y_label);
    int row = plot.y + kLegendStep / 2;
    for (const auto& [name, colour] : panel.legend) {
        canvas.fill({plot.right() + kBarGap, row - 4, kLegendLine - 14, 8}, colour);
        canvas.text(plot.right() + kBarGap + kLegendLine,
                    row,
                    name,
                    anchored(kTickText, TextAnchor::Start));
        row += kLegendStep;
    }
}

}  // namespace

void check_panel(const Panel& panel) {
    std::visit([](const auto& p) { check(p); }, panel);
}

PixelSize panel_size(const Panel& panel) {
    return std::visit(
        [](const auto& p) -> PixelSize {
            const PixelSize plot = plot_size(p);
            return {kLeftMargin + plot.width + right_margin(p),
                    kTitleHeight + plot.height + kBottomMargin};
        },
        panel);
}

void draw_panel(Canvas& canvas, int x, int y, const Panel& panel) {
    std::visit(
        [&](const auto& p) {
            const PixelSize size = plot_size(p);
            const PixelBox plot{x + kLeftMargin, y + kTitleHeight, size.width, size.height};
            canvas.text(plot.x, y + kTitleHeight / 2, p.title, kTitleText);
            draw_plot(canvas, plot, p);
        },
        panel);
}

}  // namespace nlos
