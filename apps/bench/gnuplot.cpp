// SPDX-License-Identifier: MIT
#include "apps/bench/gnuplot.h"

#include "apps/run_program.h"
#include "renderer/core/error.h"
#include "renderer/core/output_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace apps {
namespace {

/// A text of a script. Between single quotes gnuplot takes every character as it is; a quote is
/// written twice, and no printable text ends the line.
std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : core::printable(text)) {
        if (c == '\'') result += c;
        result += c;
    }
    return result + "'";
}

// The text of a gnuplot script. Data stand in it, so nothing is left beside the pictures; the
// picture goes to standard output, so no name of a file does.
std::string script_of(const Plot& plot, const std::string& terminal) {
    std::string script = fmt::format(
        "set terminal {}\n{}{}{}set grid\nset key below height 1 reverse Left "
        "samplen 3\n"
        "set linetype 9 lc rgb '#999999'\nset linetype 10 lc rgb '#8b4513'\nset linetype cycle 10\n"
        "set title {}\nset xlabel {}\nset ylabel {}\nset format '%g'\n",
        terminal,
        plot.x_scale == AxisScale::Logarithmic ? "set logscale x\n" : "",
        plot.y_scale == AxisScale::Logarithmic ? "set logscale y\n" : "",
        plot.x_ticks.empty() ? ""
                             : fmt::format("set offsets graph 0.03, graph 0.03\nset xtics ({})\n",
                                           fmt::join(plot.x_ticks, ", ")),
        quoted(plot.title),
        quoted(plot.x_label),
        quoted(plot.y_label));
    std::string data;
    std::string curves;
    for (std::size_t i = 0; i < plot.lines.size(); ++i) {
        const PlotLine& line = plot.lines[i];
        data += fmt::format("$line{} << EOD\n", i);
        for (std::size_t j = 0; j < line.x.size(); ++j) {
            data += fmt::format("{} {}\n", line.x[j], line.y[j]);
        }
        data += "EOD\n";
        curves += fmt::format(
            "{}$line{} with {} lc {} title {}",
            i == 0 ? "plot " : ", ",
            i,
            line.style == LineStyle::Measured ? "linespoints lw 2 pt 7" : "lines lw 3 dt 2",
            line.limit_of < 0 ? static_cast<int>(i) + 1 : line.limit_of + 1,
            quoted(line.title));
    }
    return script + data + curves + "\n";
}

bool draw_as(const Plot& plot, const std::string& terminal, const std::string& target) {
    core::OutputFile output(target);
    const auto status = run_program(
        {"gnuplot", "--default-settings"}, script_of(plot, terminal), output.temporary());
    if (status != 0) return false;
    output.commit();
    return true;
}

}  // namespace

PlotLine& line_named(const std::string& title, Plot& plot) {
    const auto it = std::ranges::find(plot.lines, title, &PlotLine::title);
    return it != plot.lines.end() ? *it : plot.lines.emplace_back(PlotLine{title, {}, {}});
}

PlotLine pareto_front(const std::vector<PlotLine>& lines) {
    std::vector<std::pair<double, double>> points;
    for (const PlotLine& line : lines) {
        for (std::size_t i = 0; i < line.x.size(); ++i) points.emplace_back(line.x[i], line.y[i]);
    }
    std::sort(points.begin(), points.end());
    PlotLine front{"Pareto front", {}, {}, LineStyle::Limit};
    for (const auto& [x, y] : points) {
        if (!front.y.empty() && y >= front.y.back()) continue;
        front.add(x, y);
    }
    return front;
}

bool draw_plot(const Plot& plot, const std::string& path) {
    return draw_as(plot, "svg size 800,500 dynamic noenhanced", path + ".svg") &&
           draw_as(plot, "pngcairo size 1200,750 fontscale 1.3 noenhanced", path + ".png");
}

}  // namespace apps
