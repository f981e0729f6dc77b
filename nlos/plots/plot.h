// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/plots/axis_drawing.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace nlos {

enum class LineStyle {
    Measured,  ///< points on a line
    Limit,     ///< dashed: what the machine or theory allows
    Area,      ///< a line over its shaded area
};

/// Points of one line of a plot.
struct PlotLine {
    std::string title{};  ///< in the legend; empty: it has no entry there
    std::vector<double> x{};
    std::vector<double> y{};
    LineStyle style = LineStyle::Measured;
    int limit_of = -1;  ///< the line of the plot whose limit this is and whose colour it takes

    void add(double at_x, double at_y) {
        x.push_back(at_x);
        y.push_back(at_y);
    }
};

/// Lines over two axes, with a legend below.
struct Plot {
    std::string title;
    std::string x_label;  ///< with unit
    std::string y_label;
    std::vector<PlotLine> lines{};
    std::vector<double> x_ticks{};  ///< where numbers stand along x; empty: where round ones do
    AxisScale x_scale = AxisScale::Logarithmic;
    AxisScale y_scale = AxisScale::Logarithmic;
};

/// A plot of one quantity over another, both linear, without a legend: its line is still to get its
/// points. y starts at 0 or below.
Plot area_plot(const std::string& title, const std::string& x_label, const std::string& y_label);

/// A line with a point for every row: members of it, or functions of it, are x and y.
template <class Rows, class X, class Y>
PlotLine line_of(std::string title, const Rows& rows, const X& x, const Y& y) {
    PlotLine line{std::move(title)};
    for (const auto& row : rows) {
        line.add(std::invoke(x, row), std::invoke(y, row));
    }
    return line;
}

/// The line of a plot with this title, which is added where there is none.
PlotLine& line_named(const std::string& title, Plot& plot);

/// The points of all lines that no other point beats in both coordinates, by rising x.
PlotLine pareto_front(const std::vector<PlotLine>& lines);

}  // namespace nlos
