// SPDX-License-Identifier: MIT
#include "nlos/plots/plot_drawing.h"

#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

// Sizes in pixels of the canvas.
constexpr int kWidthWithLegend = 1080;
constexpr int kEntriesTop = 122;   // below the axes
constexpr int kEntryStep = 36;     // from one row to the next
constexpr int kSampleLength = 72;  // of a line
constexpr int kEntryGap = 28;      // beside either end of a text
constexpr int kCurveThickness = 4;
constexpr int kDotSize = 14;

constexpr double kAreaOpacity = 0.15;
constexpr double kFreeFraction = 0.04;  // of an axis, beyond the outermost points

Colour colour_of(const Plot& plot, std::size_t line) {
    const int of = plot.lines[line].limit_of;
    return series_colour(of < 0 ? line : static_cast<std::size_t>(of));
}

bool is_shown(double value, AxisScale scale) {
    return std::isfinite(value) && (scale == AxisScale::Linear || value > 0.0);
}

/// The smallest and largest coordinate of all points; what every plot has where there are none.
std::array<double, 2> extent(const Plot& plot,
                             std::vector<double> PlotLine::*coordinates,
                             AxisScale scale) {
    double low = INFINITY;
    double high = -INFINITY;
    for (const PlotLine& line : plot.lines) {
        for (const double value : line.*coordinates) {
            if (!is_shown(value, scale)) continue;
            low = std::min(low, value);
            high = std::max(high, value);
        }
    }
    return low <= high ? std::array{low, high} : std::array{1.0, 10.0};
}

/// The same with some room around.
std::array<double, 2> with_room(const std::array<double, 2>& range, AxisScale scale) {
    const auto& [low, high] = range;
    if (scale == AxisScale::Logarithmic) {
        const double factor = high > low ? std::pow(high / low, kFreeFraction) : 2.0;
        return {low / factor, high * factor};
    }
    const double room = high > low ? kFreeFraction * (high - low) : 0.5;
    return {low >= 0.0 ? std::max(0.0, low - room) : low - room, high + room};
}

bool has_area(const Plot& plot) {
    return std::ranges::any_of(plot.lines,
                               [](const PlotLine& line) { return line.style == LineStyle::Area; });
}

PixelAxis x_axis(const Plot& plot, const PixelBox& box) {
    auto range = extent(plot, &PlotLine::x, plot.x_scale);
    if (!has_area(plot)) range = with_room(range, plot.x_scale);
    if (!(range[1] > range[0])) range[1] = range[0] + 1.0;
    return {range[0], range[1], box.x, box.right(), plot.x_scale, plot.x_ticks};
}

PixelAxis y_axis(const Plot& plot, const PixelBox& box) {
    auto range = extent(plot, &PlotLine::y, plot.y_scale);
    if (has_area(plot)) {
        const double bottom = std::min(0.0, range[0]);
        const double top = range[1] + 0.05 * (range[1] - bottom);
        range = {bottom, top > bottom ? top : bottom + 1.0};
    } else {
        range = with_room(range, plot.y_scale);
    }
    return {range[0], range[1], box.bottom(), box.y, plot.y_scale};
}

using Points = std::vector<std::array<double, 2>>;

void draw_area(Canvas& canvas, Points points, double bottom_px, Colour colour) {
    const std::array<double, 2> end{points.back()[0], bottom_px};
    const std::array<double, 2> begin{points.front()[0], bottom_px};
    points.insert(points.end(), {end, begin});
    canvas.fill_polygon(points, colour, kAreaOpacity);
}

void draw_line(Canvas& canvas, const Points& points, LineStyle style, Colour colour) {
    const bool is_limit = style == LineStyle::Limit;
    canvas.polyline(points, colour, kCurveThickness, is_limit ? Stroke::Dashed : Stroke::Solid);
    if (style != LineStyle::Measured) return;
    for (const auto& point : points) canvas.polyline({point, point}, colour, kDotSize);
}

/// Where the entries of a legend stand.
struct LegendLayout {
    std::vector<std::size_t> lines;  ///< those that have an entry
    int columns = 1;
    int rows = 0;
    int column_width = 0;

    LegendLayout(const Plot& plot, int width) {
        double widest = 0.0;
        for (std::size_t i = 0; i < plot.lines.size(); ++i) {
            if (plot.lines[i].title.empty()) continue;
            lines.push_back(i);
            widest = std::max(widest, Canvas::text_length(plot.lines[i].title, kTickText));
        }
        if (lines.empty()) return;
        const int count = static_cast<int>(lines.size());
        const int entry = kSampleLength + 2 * kEntryGap + static_cast<int>(std::ceil(widest));
        columns = std::clamp(width / entry, 1, count);
        rows = (count + columns - 1) / columns;
        column_width = width / columns;
    }
};

void draw_legend(Canvas& canvas, const PixelBox& box, const Plot& plot) {
    const LegendLayout layout(plot, box.width);
    int number = 0;
    for (const std::size_t i : layout.lines) {
        const int x = box.x + number / layout.rows * layout.column_width;
        const int y = box.bottom() + kEntriesTop + kEntryStep * (number % layout.rows);
        const PlotLine& line = plot.lines[i];
        const Points ends{{double(x), double(y)}, {double(x + kSampleLength), double(y)}};
        canvas.polyline(ends,
                        colour_of(plot, i),
                        kCurveThickness,
                        line.style == LineStyle::Limit ? Stroke::Dashed : Stroke::Solid);
        if (line.style == LineStyle::Measured) {
            const std::array<double, 2> middle{x + 0.5 * kSampleLength, double(y)};
            canvas.polyline({middle, middle}, colour_of(plot, i), kDotSize);
        }
        canvas.text(x + kSampleLength + kEntryGap / 2,
                    y,
                    line.title,
                    fitted(kTickText, line.title, layout.column_width - kSampleLength - kEntryGap));
        ++number;
    }
}

}  // namespace

void check(const Plot& plot) {
    for (const PlotLine& line : plot.lines) {
        if (line.x.size() == line.y.size()) continue;
        throw core::Error("picture '" + plot.title + "'",
                          fmt::format("found {} x and {} y", line.x.size(), line.y.size()),
                          "must be as many");
    }
}

PixelSize plot_size(const Plot& plot) {
    return {legend_height(plot) > 0 ? kWidthWithLegend : kPlotSize, kPlotSize};
}

int legend_height(const Plot& plot) {
    return kEntryStep * LegendLayout(plot, kWidthWithLegend).rows;
}

void draw_plot(Canvas& canvas, const PixelBox& box, const Plot& plot) {
    const PixelAxis x = x_axis(plot, box);
    const PixelAxis y = y_axis(plot, box);
    draw_grid(canvas, box, x, y);
    for (std::size_t i = 0; i < plot.lines.size(); ++i) {
        const PlotLine& line = plot.lines[i];
        Points points;
        for (std::size_t j = 0; j < line.x.size(); ++j) {
            if (!is_shown(line.x[j], x.scale) || !is_shown(line.y[j], y.scale)) continue;
            points.push_back({x.pixel(line.x[j]), y.pixel(line.y[j])});
        }
        if (points.empty()) continue;
        if (line.style == LineStyle::Area) {
            draw_area(canvas, points, y.pixel(0.0), colour_of(plot, i));
        }
        draw_line(canvas, points, line.style, colour_of(plot, i));
    }
    draw_axes(canvas, box, x, y, plot.x_label, plot.y_label);
    draw_legend(canvas, box, plot);
}

}  // namespace nlos
