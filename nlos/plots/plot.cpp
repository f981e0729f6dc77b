// SPDX-License-Identifier: MIT
#include "nlos/plots/plot.h"

#include <algorithm>

namespace nlos {

Plot area_plot(const std::string& title, const std::string& x_label, const std::string& y_label) {
    Plot plot{title, x_label, y_label, {{.style = LineStyle::Area}}};
    plot.x_scale = AxisScale::Linear;
    plot.y_scale = AxisScale::Linear;
    return plot;
}

PlotLine& line_named(const std::string& title, Plot& plot) {
    const auto it = std::ranges::find(plot.lines, title, &PlotLine::title);
    return it != plot.lines.end() ? *it : plot.lines.emplace_back(PlotLine{title});
}

PlotLine pareto_front(const std::vector<PlotLine>& lines) {
    std::vector<std::pair<double, double>> points;
    for (const PlotLine& line : lines) {
        for (std::size_t i = 0; i < line.x.size(); ++i) points.emplace_back(line.x[i], line.y[i]);
    }
    std::sort(points.begin(), points.end());
    PlotLine front{.title = "Pareto front", .style = LineStyle::Limit};
    for (const auto& [x, y] : points) {
        if (!front.y.empty() && y >= front.y.back()) continue;
        front.add(x, y);
    }
    return front;
}

}  // namespace nlos
