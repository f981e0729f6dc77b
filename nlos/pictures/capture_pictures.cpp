// SPDX-License-Identifier: MIT
#include "nlos/canvas/canvas.h"
#include "nlos/pictures/animation.h"
#include "nlos/pictures/image_layout.h"
#include "nlos/pictures/light_scale.h"
#include "nlos/pictures/pictures.h"
#include "nlos/preparation/wall_frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nlos {
namespace {

constexpr double kBrightestFraction = 0.0005;  // of a streak's values, drawn in the last colour

constexpr double kScreenGamma = 2.2;
constexpr int kPreviewWidth = 640;        // [pixels] that small images are enlarged to
constexpr std::size_t kShownFrames = 12;  // of a sequence, drawn one by one
constexpr std::size_t kMaxGates = 4;      // of an image's histogram, drawn one by one

constexpr float kBackground = std::numeric_limits<float>::quiet_NaN();  // what nobody observed

ImagePanel streak_panel(const core::Capture& capture,
                        const core::WallScan& scan,
                        const std::optional<WallGrid>& grid,
                        const std::array<std::size_t, 2>& bins) {
    std::vector<std::size_t> points(grid ? grid->size[0] : scan.scanned_points().size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i] = grid ? grid->point(i, grid->size[1] / 2) : i;
    }
    ImagePanel panel =
        image_of(points.size(), bins[1] - bins[0], [&](std::size_t i, std::size_t bin) {
            return capture.transient.histogram(pair_of(scan, points[i]))[bins[0] + bin];
        });
    panel.title = grid ? "Streak of the middle row" : "Streak of all points";
    panel.x_label = grid ? kWallX : "number of the point";
    panel.x_range = grid ? cell_edges(grid->first_m[0], grid->pitch_m[0], points.size())
                         : cell_edges(0.0, 1.0, points.size());
    panel.y_range = {capture.time_axis.bin_begin_m(static_cast<double>(bins[0])),
                     capture.time_axis.bin_begin_m(static_cast<double>(bins[1]))};
    panel.y_label = "path length [m]";
    if (grid) panel.x_direction = AxisDirection::Reversed;  // as the wall beside it is seen
    panel.y_direction = AxisDirection::Reversed;
    panel.value_label = light_per_bin_label(capture);
    panel.aspect = AspectRatio::Free;
    panel.value_range = light_range(panel.values, kBrightestFraction);
    choose_scale(panel);
    for (std::size_t i = 0; i < panel.values.size(); ++i) {
        const std::size_t pair = pair_of(scan, points[i % points.size()]);
        const auto bin = static_cast<int>(bins[0] + i / points.size());
        if (!capture.observed_range(pair).holds(bin)) panel.values[i] = kBackground;
    }
    return panel;
}

Plot mean_plot(const core::Capture& capture,
               const std::string& title,
               const std::vector<double>& mean,
               const std::array<std::size_t, 2>& bins) {
    Plot plot = area_plot(title, "path length [m]", light_per_bin_label(capture));
    for (std::size_t bin = bins[0]; bin < bins[1]; ++bin) {
        plot.lines.front().add(capture.time_axis.bin_center_m(static_cast<double>(bin)), mean[bin]);
    }
    return plot;
}

/// The image of all light, the mean transient, and the image in a few gates that share the time
/// in which there is light.
std::vector<Panel> light_panels(const core::Capture& capture, const core::ImageScan& image) {
    const std::size_t num_bins = capture.transient.num_bins();
    const auto gated = [&](const std::string& title, const std::array<std::size_t, 2>& bins) {
        ImagePanel panel = gated_panel(image.camera, capture.transient, bins);
        panel.title = title;
        panel.value_label = light_label(capture);
        return panel;
    };
    if (num_bins == 1) return {gated("Path length " + axis_text(capture.time_axis), {0, 1})};
    std::vector<Panel> panels{gated("Light of all bins", {0, num_bins})};
    const std::vector<double> mean = mean_transient(capture);
    const std::array<std::size_t, 2> shown = shown_bins(mean);
    panels.emplace_back(mean_plot(capture, "Mean transient of all pixels", mean, shown));
    const std::size_t num_gates = std::min(kMaxGates, shown[1] - shown[0]);
    for (std::size_t i = 0; i < num_gates; ++i) {
        const std::size_t first = shown[0] + i * (shown[1] - shown[0]) / num_gates;
        const std::size_t last = shown[0] + (i + 1) * (shown[1] - shown[0]) / num_gates;
        core::TimeAxis gate = capture.time_axis;
        gate.opl_start_m = gate.bin_begin_m(static_cast<double>(first));
        gate.num_bins = static_cast<int>(last - first);
        panels.emplace_back(gated("Path length " + axis_text(gate), {first, last}));
    }
    return panels;
}

/// Streak image, light over the wall and mean transient, as far as there are these.
std::vector<Panel> light_panels(const core::Capture& capture, const core::WallScan& scan) {
    const std::optional<WallGrid> grid = derive_wall_frame(scan).grid;
    const std::vector<double> mean = mean_transient(capture);
    const std::array<std::size_t, 2> bins = shown_bins(mean);
    const bool has_time = capture.transient.num_bins() > 1;
    std::vector<Panel> panels;
    if (has_time || !grid) panels.emplace_back(streak_panel(capture, scan, grid, bins));
    if (grid) panels.emplace_back(light_panel(capture, capture.transient, *grid));
    if (has_time) {
        panels.emplace_back(mean_plot(capture, "Mean transient of all points", mean, bins));
    }
    return panels;
}

}  // namespace

std::string encode_preview_png(const core::Capture& capture, const core::PinholeCamera& camera) {
    const ImagePanel panel =
        gated_panel(camera, capture.transient, {0, capture.transient.num_bins()});
    const double white = (*panel.value_range)[1];
    std::vector<Colour> colours;
    for (const float value : panel.values) {
        const double fraction = white > 0.0 ? std::clamp(double{value} / white, 0.0, 1.0) : 0.0;
        colours.push_back(colour_at(ColourMap::Grey, std::pow(fraction, 1.0 / kScreenGamma)));
    }
    const auto& [width, height] = camera.resolution;
    const int zoom = std::max(1, kPreviewWidth / width);
    Canvas canvas(zoom * width, zoom * height, {});
    canvas.image({0, 0, zoom * width, zoom * height}, width, height, colours);
    return canvas.finish();
}

std::vector<Panel> capture_panels(const core::Capture& capture) {
    std::vector<Panel> panels;
    if (capture.sequence) {
        for (ImagePanel& frame : sequence_panels(capture, kShownFrames)) {
            panels.emplace_back(std::move(frame));
        }
    }
    if (panels.empty()) {
        panels = capture.scan.visit([&](const auto& kind) { return light_panels(capture, kind); });
    }
    const std::vector<Panel> velocities = velocity_panels(capture);
    panels.insert(panels.end(), velocities.begin(), velocities.end());
    return panels;
}

}  // namespace nlos
