// SPDX-License-Identifier: MIT
#include "apps/bench/gnuplot.h"

#include "renderer/core/output_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace apps {
namespace {

// The text of a gnuplot script; data stand in it, so nothing is left beside the pictures.
std::string script_of(const LogPlot& plot, const std::string& terminal, const std::string& target) {
    std::string script = fmt::format(
        "set terminal {}\nset output '{}'\nset logscale xy\nset grid\nset key below reverse Left "
        "samplen 3\n"
        "set linetype 9 lc rgb '#999999'\nset linetype 10 lc rgb '#8b4513'\nset linetype cycle 10\n"
        "set title '{}'\nset xlabel '{}'\nset ylabel '{}'\nset format '%g'\n",
        terminal,
        target,
        plot.title,
        plot.x_label,
        plot.y_label);
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
            "{}$line{} with {} lc {} title '{}'",
            i == 0 ? "plot " : ", ",
            i,
            line.style == LineStyle::Measured ? "linespoints lw 2 pt 7" : "lines lw 3 dt 2",
            line.limit_of < 0 ? static_cast<int>(i) + 1 : line.limit_of + 1,
            line.title);
    }
    return script + data + curves + "\n";
}

bool run_gnuplot(const std::string& script) {
    std::FILE* pipe = ::popen("gnuplot 2>/dev/null", "w");
    if (pipe == nullptr) return false;
    std::fwrite(script.data(), 1, script.size(), pipe);
    return ::pclose(pipe) == 0;
}

bool draw_as(const LogPlot& plot, const std::string& terminal, const std::string& target) {
    core::OutputFile output(target);
    if (!run_gnuplot(script_of(plot, terminal, output.temporary()))) return false;
    output.commit();
    return true;
}

}  // namespace

PlotLine pareto_front(const std::vector<PlotLine>& lines) {
    std::vector<std::pair<double, double>> points;
    for (const PlotLine& line : lines) {
        for (std::size_t i = 0; i < line.x.size(); ++i) points.emplace_back(line.x[i], line.y[i]);
    }
    std::sort(points.begin(), points.end());
    PlotLine front{"Pareto front", {}, {}, LineStyle::Limit};
    for (const auto& [x, y] : points) {
        if (!front.y.empty() && y >= front.y.back()) continue;
        front.x.push_back(x);
        front.y.push_back(y);
    }
    return front;
}

bool draw_plot(const LogPlot& plot, const std::string& path) {
    return draw_as(plot, "svg size 800,500 dynamic noenhanced", path + ".svg") &&
           draw_as(plot, "pngcairo size 1200,750 fontscale 1.3 noenhanced", path + ".png");
}

}  // namespace apps
