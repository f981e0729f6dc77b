// SPDX-License-Identifier: MIT
#include "apps/bench/field/field_plots.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace apps {
namespace {

PlotLine& line_of(Plot& plot, const std::string& title) {
    const auto it = std::ranges::find(plot.lines, title, &PlotLine::title);
    return it != plot.lines.end() ? *it : plot.lines.emplace_back(PlotLine{title, {}, {}});
}

void add(PlotLine& line, double x, std::optional<double> y) {
    if (!y || !(*y > 0.0)) return;
    line.x.push_back(x);
    line.y.push_back(*y);
}

}  // namespace

std::map<std::string, Plot> reconstruction_plots(
    const std::vector<ReconstructionSummary>& summaries) {
    std::map<std::string, Plot> plots;
    for (const ReconstructionSummary& s : summaries) {
        if (!s.cpu_s) continue;
        const std::string of = fmt::format("{}, {} x {} points", s.pattern, s.points, s.points);
        const std::string suffix = fmt::format("_{}_{}", s.pattern, s.points);
        const std::string title = s.program + " " + s.method;
        Plot& time = plots["_time" + suffix];
        time.title = "Error against time, without noise, " + of;
        time.x_label = "CPU time of the calculation [s]";
        time.y_label = "mean depth error, median of the scenes [mm]";
        add(line_of(time, title), *s.cpu_s, s.clean_mae_mm);
        if (!s.mae_mm_3) continue;
        Plot& photons = plots["_photons" + suffix];
        photons.title = "Photons against accuracy, " + of;
        photons.x_label = "counts per wall point";
        photons.y_label = time.y_label;
        photons.x_ticks = {3, 20, 100};
        PlotLine& line = line_of(photons, title);
        add(line, 3, s.mae_mm_3);
        add(line, 20, s.mae_mm_20);
        add(line, 100, s.mae_mm_100);
    }
    for (auto& [suffix, plot] : plots) {
        if (suffix.starts_with("_time")) plot.lines.push_back(pareto_front(plot.lines));
    }
    return plots;
}

std::map<std::string, Plot> rendering_plots(const std::vector<RenderingRow>& rows) {
    std::map<std::string, Plot> plots;
    for (const RenderingRow& row : rows) {
        if (!row.cpu_s) continue;
        Plot& plot = plots[fmt::format("_render_{}_{}", row.scene, row.max_bounces)];
        plot.title =
            fmt::format("Error against time, {}, up to {} bounces", row.scene, row.max_bounces);
        plot.x_label = "CPU time of the rendering [s]";
        plot.y_label = "relative L2 error over all of H";
        add(line_of(plot, row.program + " " + row.method), *row.cpu_s, row.rel_l2);
    }
    for (auto& [suffix, plot] : plots) plot.lines.push_back(pareto_front(plot.lines));
    return plots;
}

}  // namespace apps
