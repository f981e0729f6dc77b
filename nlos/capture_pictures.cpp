// SPDX-License-Identifier: MIT
#include "nlos/pictures.h"
#include "nlos/wall_frame.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr double kQuietShare = 0.002;       // of all light, left out at either end of the axis
constexpr double kShownMargin = 0.02;       // of the axis, kept around what is shown
constexpr double kBrightestShare = 0.0005;  // of a streak's values, drawn in the last colour

using Range = std::array<double, 2>;

/// Outer edges of `count` cells of width `pitch` whose first centre is `first`.
Range cell_edges(double first, double pitch, std::size_t count) {
    return {first - 0.5 * pitch, first + (static_cast<double>(count) - 0.5) * pitch};
}

std::string unit_of(const core::Capture& capture) {
    return capture.unit == core::TransientUnit::Counts ? "counts" : "radiance";
}

/// The mean histogram over all pairs.
std::vector<double> mean_transient(const core::Capture& capture) {
    const core::Transient& transient = capture.transient;
    std::vector<double> mean(transient.num_bins(), 0.0);
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        const auto histogram = transient.histogram(pair);
        for (std::size_t bin = 0; bin < mean.size(); ++bin) mean[bin] += histogram[bin];
    }
    for (double& value : mean) value /= static_cast<double>(transient.num_pairs());
    return mean;
}

/// First and one past the last bin worth showing: all but the quiet ends.
std::array<std::size_t, 2> shown_bins(const std::vector<double>& mean) {
    double total = 0.0;
    for (const double value : mean) total += std::max(0.0, value);
    if (!(total > 0.0)) return {0, mean.size()};
    std::size_t first = mean.size();
    std::size_t last = 0;
    double sum = 0.0;
    for (std::size_t bin = 0; bin < mean.size(); ++bin) {
        sum += std::max(0.0, mean[bin]);
        if (first == mean.size() && sum > kQuietShare * total) first = bin;
        if (sum <= (1.0 - kQuietShare) * total) last = bin + 1;
    }
    const auto margin =
        static_cast<std::size_t>(std::ceil(kShownMargin * static_cast<double>(mean.size())));
    return {first > margin ? first - margin : 0, std::min(mean.size(), last + 1 + margin)};
}

/// The pair of a sensing point, with the middle illumination point of exhaustive scans.
std::size_t pair_of(const core::Scan& scan, std::size_t sensing) {
    if (scan.pattern != core::ScanPattern::Exhaustive) return sensing;
    return scan.illumination.size() / 2 * scan.sensing.size() + sensing;
}

/// The range from 0 to all but the brightest values, so that a few cannot darken the rest.
Range light_range(std::vector<float> values) {
    const double share = 1.0 - kBrightestShare;
    const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    return {0.0, static_cast<double>(values[static_cast<std::size_t>(rank)])};
}

ImagePanel streak_panel(const core::Capture& capture,
                        const std::optional<WallGrid>& grid,
                        const std::array<std::size_t, 2>& bins) {
    std::vector<std::size_t> points(grid ? grid->size[0] : capture.scan.sensing.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i] = grid ? grid->point(i, grid->size[1] / 2) : i;
    }
    ImagePanel panel;
    panel.title = grid ? "Streak of the middle row" : "Streak of all points";
    panel.width = points.size();
    panel.height = bins[1] - bins[0];
    for (std::size_t bin = bins[0]; bin < bins[1]; ++bin) {
        for (const std::size_t point : points) {
            panel.values.push_back(capture.transient.histogram(pair_of(capture.scan, point))[bin]);
        }
    }
    panel.x_label = grid ? "wall x [m]" : "number of the point";
    panel.x_range = grid ? cell_edges(grid->first_m[0], grid->pitch_m[0], points.size())
                         : cell_edges(0.0, 1.0, points.size());
    panel.y_range = {capture.time_axis.bin_begin_m(static_cast<double>(bins[0])),
                     capture.time_axis.bin_begin_m(static_cast<double>(bins[1]))};
    panel.y_label = "path length [m]";
    panel.y_direction = AxisDirection::Reversed;
    panel.value_label = unit_of(capture) + " per bin";
    panel.scale = AxisScale::Free;
    panel.value_range = light_range(panel.values);
    return panel;
}

/// All light of every sensing point, the wall seen like every front view.
ImagePanel wall_panel(const core::Capture& capture, const WallGrid& grid) {
    std::vector<double> light(capture.scan.sensing.size(), 0.0);
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        double& sum = light[capture.scan.sensing_index(pair)];
        for (const float value : capture.transient.histogram(pair)) sum += value;
    }
    ImagePanel panel;
    panel.title = "Light over the wall, all bins";
    panel.width = grid.size[0];
    panel.height = grid.size[1];
    for (std::size_t iy = 0; iy < panel.height; ++iy) {
        for (std::size_t ix = 0; ix < panel.width; ++ix) {
            panel.values.push_back(static_cast<float>(light[grid.point(ix, iy)]));
        }
    }
    panel.x_range = cell_edges(grid.first_m[0], grid.pitch_m[0], panel.width);
    panel.y_range = cell_edges(grid.first_m[1], grid.pitch_m[1], panel.height);
    panel.x_label = "wall x [m]";
    panel.y_label = "wall y [m]";
    panel.value_label = unit_of(capture);
    panel.x_direction = AxisDirection::Reversed;
    return panel;
}

CurvePanel curve_panel(const core::Capture& capture,
                       const std::vector<double>& mean,
                       const std::array<std::size_t, 2>& bins) {
    CurvePanel panel;
    panel.title = "Mean transient of all points";
    for (std::size_t bin = bins[0]; bin < bins[1]; ++bin) {
        panel.x.push_back(capture.time_axis.bin_center_m(static_cast<double>(bin)));
        panel.y.push_back(mean[bin]);
    }
    panel.x_label = "path length [m]";
    panel.y_label = unit_of(capture) + " per bin";
    return panel;
}

}  // namespace

std::vector<Panel> capture_panels(const core::Capture& capture) {
    const std::optional<WallGrid> grid = derive_wall_frame(capture.scan).grid;
    const std::vector<double> mean = mean_transient(capture);
    const std::array<std::size_t, 2> bins = shown_bins(mean);
    const bool has_time = capture.transient.num_bins() > 1;
    std::vector<Panel> panels;
    if (has_time || !grid) panels.emplace_back(streak_panel(capture, grid, bins));
    if (grid) panels.emplace_back(wall_panel(capture, *grid));
    if (has_time) panels.emplace_back(curve_panel(capture, mean, bins));
    return panels;
}

}  // namespace nlos
