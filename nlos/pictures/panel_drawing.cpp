// SPDX-License-Identifier: MIT
#include "nlos/pictures/panel_drawing.h"

#include "nlos/plots/plot_drawing.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

// Sizes in pixels of the canvas.
constexpr int kTitleHeight = 66;
constexpr int kBarGap = 28;
constexpr int kBarWidth = 22;
constexpr int kBarLabels = 132;
constexpr int kLegendLine = 44;
constexpr int kLegendStep = 40;
constexpr int kPanelGap = 44;  // to the next panel

constexpr Colour kNoValue{214, 217, 222};
constexpr Colour kNoCategory{255, 255, 255};

constexpr TextStyle kTitleText{18.0, kInk, TextAnchor::Start};

PixelAxis pixel_axis(const std::array<double, 2>& range,
                     AxisDirection direction,
                     int begin_px,
                     int end_px) {
    if (direction == AxisDirection::Reversed) std::swap(begin_px, end_px);
    return {range[0], range[1], begin_px, end_px};
}

// ---- Sizes -------------------------------------------------------------------------------------

/// A plot on which a unit is as long along x as along y.
///
/// full_length   what the usual size of a plot stands for; 0: the longer axis
PixelSize equal_size(const std::array<double, 2>& x_range,
                     const std::array<double, 2>& y_range,
                     double full_length) {
    const double width = std::abs(x_range[1] - x_range[0]);
    const double height = std::abs(y_range[1] - y_range[0]);
    const double longest = full_length > 0.0 ? full_length : std::max(width, height);
    const auto side = [&](double length) {
        return std::max(2, static_cast<int>(std::lround(length / longest * kPlotSize)));
    };
    return {side(width), side(height)};
}

PixelSize plot_size(const ImagePanel& panel) {
    if (panel.aspect == AspectRatio::Free) return {kPlotSize, kPlotSize};
    return equal_size(panel.x_range, panel.y_range, panel.full_length);
}

PixelSize plot_size(const DrawingPanel& panel) {
    return equal_size(panel.x_range, panel.y_range, 0.0);
}

/// What a plot takes beside its margins.
PixelSize room_of(const PixelSize& plot) {
    return {std::max(kSmallestRoom, plot.width), std::max(kSmallestRoom, plot.height)};
}

using Legend = std::vector<std::pair<std::string, Colour>>;

int legend_width(const Legend& legend) {
    double widest = 0.0;
    for (const auto& [name, colour] : legend) {
        widest = std::max(widest, Canvas::text_length(name, kTickText));
    }
    return kLegendLine + static_cast<int>(std::ceil(widest));
}

int right_margin(const ImagePanel& panel) {
    const bool has_legend = !panel.categories.empty();
    return kBarGap + (has_legend ? legend_width(panel.categories) : kBarWidth + kBarLabels) +
           kPanelGap;
}
int right_margin(const Plot&) {
    return kPanelGap;
}
int right_margin(const DrawingPanel& panel) {
    return kBarGap + legend_width(panel.legend) + kPanelGap;
}

template <class AnyPanel>
int bottom_margin(const AnyPanel&) {
    return kBottomMargin;
}
int bottom_margin(const Plot& plot) {
    return kBottomMargin + legend_height(plot);
}

void check(const ImagePanel& panel) {
    if (panel.width > 0 && panel.values.size() == panel.width * panel.height) return;
    throw core::Error(
        "picture '" + panel.title + "'",
        fmt::format("found {} values for {} x {}", panel.values.size(), panel.width, panel.height),
        "must be one value per pixel and at least one");
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
double colour_fraction(const ImagePanel& panel, const std::array<double, 2>& range, double value) {
    const double fraction = (value - range[0]) / (range[1] - range[0]);
    return panel.value_scale == ValueScale::Gamma ? std::sqrt(std::max(0.0, fraction)) : fraction;
}

Colour colour_of(const ImagePanel& panel, const std::array<double, 2>& range, float value) {
    if (!std::isfinite(value)) return kNoValue;
    if (panel.categories.empty()) {
        return colour_at(panel.colour_map, colour_fraction(panel, range, double{value}));
    }
    const auto number = static_cast<std::size_t>(std::max(0.0F, value));
    return number == 0 || number > panel.categories.size() ? kNoCategory
                                                           : panel.categories[number - 1].second;
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
            colours.push_back(colour_of(panel, range, panel.values[iy * panel.width + ix]));
        }
    }
    return colours;
}

void draw_colour_bar(Canvas& canvas,
                     const PixelBox& bar,
                     const ImagePanel& panel,
                     const std::array<double, 2>& range) {
    const auto& table = colours_of(panel.colour_map);
    canvas.image(bar, 1, static_cast<int>(table.size()), {table.rbegin(), table.rend()});
    canvas.frame(bar, kAxisColour, kLine);

    const PixelAxis axis{0.0, 1.0, bar.bottom(), bar.y};
    const AxisTicks ticks = choose_ticks(range[0], range[1], tick_count(bar.height));
    for (std::size_t i = 0; i < ticks.values.size(); ++i) {
        const int y = static_cast<int>(
            std::lround(axis.pixel(colour_fraction(panel, range, ticks.values[i]))));
        canvas.fill({bar.right() + kLine, y - kLine / 2, kTickLength, kLine}, kAxisColour);
        canvas.text(bar.right() + 18, y, ticks.labels[i], kTickText);
    }
    const std::string label = label_with_exponent(panel.value_label, ticks.exponent) +
                              (panel.value_scale == ValueScale::Gamma ? ", square-root scale" : "");
    canvas.text(bar.right() + kBarLabels - 16,
                bar.y + bar.height / 2,
                label,
                upwards(fitted(kLabelText, label, bar.height + kTitleHeight)));
}

/// Draws a legend whose upper left corner is (x, y).
void draw_legend(Canvas& canvas, int x, int y, const Legend& legend) {
    int row = y + kLegendStep / 2;
    for (const auto& [name, colour] : legend) {
        canvas.fill({x, row - 4, kLegendLine - 14, 8}, colour);
        canvas.text(x + kLegendLine, row, name, kTickText);
        row += kLegendStep;
    }
}

void draw_plot(Canvas& canvas, const PixelBox& plot, const ImagePanel& panel) {
    const std::array<double, 2> range = value_range(panel);
    canvas.image(plot,
                 static_cast<int>(panel.width),
                 static_cast<int>(panel.height),
                 panel_colours(panel, range));
    draw_axes(canvas,
              plot,
              pixel_axis(panel.x_range, panel.x_direction, plot.x, plot.right()),
              pixel_axis(panel.y_range, panel.y_direction, plot.bottom(), plot.y),
              panel.x_label,
              panel.y_label);
    const PixelSize room = room_of({plot.width, plot.height});
    const int bar_x = plot.x + (plot.width + room.width) / 2 + kBarGap;
    const int bar_y = plot.y + (plot.height - room.height) / 2;
    if (!panel.categories.empty()) {
        draw_legend(canvas, bar_x, bar_y, panel.categories);
        return;
    }
    draw_colour_bar(canvas, {bar_x, bar_y, kBarWidth, room.height}, panel, range);
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
    draw_axes(canvas, plot, x, y, panel.x_label, panel.y_label);
    draw_legend(canvas, plot.right() + kBarGap, plot.y, panel.legend);
}

}  // namespace

void check_panel(const Panel& panel) {
    std::visit([](const auto& p) { check(p); }, panel);
}

PixelSize panel_size(const Panel& panel) {
    return std::visit(
        [](const auto& p) -> PixelSize {
            const PixelSize room = room_of(plot_size(p));
            return {kLeftMargin + room.width + right_margin(p),
                    kTitleHeight + room.height + bottom_margin(p)};
        },
        panel);
}

void draw_panel(Canvas& canvas, int x, int y, const Panel& panel) {
    std::visit(
        [&](const auto& p) {
            const PixelSize size = plot_size(p);
            const PixelSize room = room_of(size);
            const PixelBox plot{x + kLeftMargin + (room.width - size.width) / 2,
                                y + kTitleHeight + (room.height - size.height) / 2,
                                size.width,
                                size.height};
            canvas.text(x + kLeftMargin,
                        y + kTitleHeight / 2,
                        p.title,
                        fitted(kTitleText, p.title, room.width + right_margin(p) - kPanelGap / 2));
            draw_plot(canvas, plot, p);
        },
        panel);
}

}  // namespace nlos
