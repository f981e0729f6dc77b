// SPDX-License-Identifier: MIT
#include "nlos/pictures/canvas.h"
#include "nlos/pictures/image_layout.h"
#include "nlos/pictures/pictures.h"
#include "nlos/preparation/wall_frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace nlos {
namespace {

constexpr double kQuietShare = 0.002;       // of all light, left out at either end of the axis
constexpr double kShownMargin = 0.02;       // of the axis, kept around what is shown
constexpr double kBrightestShare = 0.0005;  // of a streak's values, drawn in the last colour

constexpr double kBrightestPixels = 0.01;  // of an image's values: highlights, fireflies
constexpr double kScreenGamma = 2.2;
constexpr int kPreviewWidth = 640;      // [pixels] that small images are enlarged to
constexpr std::size_t kMaxFrames = 12;  // of a sequence, drawn one by one
constexpr std::size_t kMaxGates = 4;    // of an image's histogram, drawn one by one

constexpr float kBackground = std::numeric_limits<float>::quiet_NaN();  // what nobody observed

using Range = std::array<double, 2>;

std::string unit_of(const core::Capture& capture) {
    return capture.unit == core::TransientUnit::Counts ? "counts" : "radiance";
}

/// The mean histogram over all pairs that observed a bin; 0 where none did.
std::vector<double> mean_transient(const core::Capture& capture) {
    const core::Transient& transient = capture.transient;
    std::vector<double> mean(transient.num_bins(), 0.0);
    std::vector<double> seen(transient.num_bins(), 0.0);
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        auto bin = static_cast<std::size_t>(capture.observed_range(pair).begin);
        for (const float value : capture.observed_values(pair)) {
            mean[bin] += value;
            ++seen[bin++];
        }
    }
    for (std::size_t bin = 0; bin < mean.size(); ++bin) mean[bin] /= std::max(1.0, seen[bin]);
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

/// The range from 0 to all but a share of brightest values, so that a few cannot darken the rest.
Range light_range(std::vector<float> values, double brightest_share) {
    std::erase_if(values, [](float value) { return std::isnan(value); });
    if (values.empty()) return {0.0, 0.0};
    const double share = 1.0 - brightest_share;
    const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    const float bright = values[static_cast<std::size_t>(rank)];
    // A gate may hold so little that the share is all of it.
    const float top = bright > 0.0F ? bright : *std::max_element(values.begin(), values.end());
    return {0.0, double{top}};
}

/// Light of which most is far below the brightest is drawn on a scale that shows it.
void choose_scale(ImagePanel& panel) {
    constexpr double kFaint = 0.1;  // of the range's top: the middle of what is lit
    std::vector<float> lit;
    for (const float value : panel.values) {
        if (value > 0.0F) lit.push_back(value);
    }
    if (lit.empty()) return;
    const auto middle = lit.begin() + static_cast<std::ptrdiff_t>(lit.size() / 2);
    std::nth_element(lit.begin(), middle, lit.end());
    if (*middle < kFaint * (*panel.value_range)[1]) panel.value_scale = ValueScale::Gamma;
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
    if (grid) panel.x_direction = AxisDirection::Reversed;  // as the wall beside it is seen
    panel.y_direction = AxisDirection::Reversed;
    panel.value_label = unit_of(capture) + " per bin";
    panel.scale = AxisScale::Free;
    panel.value_range = light_range(panel.values, kBrightestShare);
    choose_scale(panel);
    for (std::size_t i = 0; i < panel.values.size(); ++i) {
        const std::size_t pair = pair_of(capture.scan, points[i % points.size()]);
        const auto bin = static_cast<int>(bins[0] + i / points.size());
        if (!capture.observed_range(pair).holds(bin)) panel.values[i] = kBackground;
    }
    return panel;
}

/// All light of every sensing point, the wall seen like every front view; nothing for dead points.
ImagePanel light_panel(const core::Capture& capture,
                       const core::Transient& transient,
                       const WallGrid& grid) {
    std::vector<double> light(capture.scan.sensing.size(), 0.0);
    std::vector<int> seen(light.size(), 0);  // bins
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        double& sum = light[capture.scan.sensing_index(pair)];
        for (const float value : transient.histogram(pair)) sum += value;
        seen[capture.scan.sensing_index(pair)] += capture.observed_range(pair).size();
    }
    for (std::size_t i = 0; i < light.size(); ++i) {
        if (seen[i] == 0) light[i] = kBackground;
    }
    ImagePanel panel = wall_panel(grid, {light.begin(), light.end()});
    panel.title = "Light over the wall, all bins";
    panel.value_label = unit_of(capture);
    return panel;
}

CurvePanel curve_panel(const core::Capture& capture,
                       const std::vector<double>& mean,
                       const std::array<std::size_t, 2>& bins) {
    CurvePanel panel;
    panel.title =
        capture.scan.camera ? "Mean transient of all pixels" : "Mean transient of all points";
    for (std::size_t bin = bins[0]; bin < bins[1]; ++bin) {
        panel.x.push_back(capture.time_axis.bin_center_m(static_cast<double>(bin)));
        panel.y.push_back(mean[bin]);
    }
    panel.x_label = "path length [m]";
    panel.y_label = unit_of(capture) + " per bin";
    return panel;
}

/// Bins [first, last) of every pixel, summed, as the camera sees them.
ImagePanel gated_panel(const core::PinholeCamera& camera,
                       const core::Transient& transient,
                       const std::array<std::size_t, 2>& bins) {
    std::vector<float> sums;
    for (std::size_t pixel = 0; pixel < transient.num_pairs(); ++pixel) {
        const auto gate = transient.histogram(pixel).subspan(bins[0], bins[1] - bins[0]);
        sums.push_back(std::accumulate(gate.begin(), gate.end(), 0.0F));
    }
    ImagePanel panel = camera_panel(camera, sums);
    panel.value_range = light_range(panel.values, kBrightestPixels);
    choose_scale(panel);
    return panel;
}

std::string axis_text(const core::TimeAxis& axis) {
    return fmt::format("{:.4g} to {:.4g} m", axis.opl_start_m, axis.opl_end_m());
}

/// The image of all light, the mean transient, and the image in a few gates that share the time
/// in which there is light.
std::vector<Panel> image_panels(const core::Capture& capture) {
    const core::PinholeCamera& camera = *capture.scan.camera;
    const std::size_t num_bins = capture.transient.num_bins();
    const auto gated = [&](const std::string& title, const std::array<std::size_t, 2>& bins) {
        ImagePanel panel = gated_panel(camera, capture.transient, bins);
        panel.title = title;
        panel.value_label = unit_of(capture);
        return panel;
    };
    if (num_bins == 1) return {gated("Path length " + axis_text(capture.time_axis), {0, 1})};
    std::vector<Panel> panels{gated("Light of all bins", {0, num_bins})};
    const std::vector<double> mean = mean_transient(capture);
    const std::array<std::size_t, 2> shown = shown_bins(mean);
    panels.emplace_back(curve_panel(capture, mean, shown));
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
std::vector<Panel> scan_panels(const core::Capture& capture) {
    const std::optional<WallGrid> grid = derive_wall_frame(capture.scan).grid;
    const std::vector<double> mean = mean_transient(capture);
    const std::array<std::size_t, 2> bins = shown_bins(mean);
    const bool has_time = capture.transient.num_bins() > 1;
    std::vector<Panel> panels;
    if (has_time || !grid) panels.emplace_back(streak_panel(capture, grid, bins));
    if (grid) panels.emplace_back(light_panel(capture, capture.transient, *grid));
    if (has_time) panels.emplace_back(curve_panel(capture, mean, bins));
    return panels;
}

/// A few frames of a sequence, all on one scale; nothing for point lists, which make no image.
std::vector<Panel> film_strip(const core::Capture& capture) {
    const core::FrameSequence& sequence = *capture.sequence;
    const std::optional<WallGrid> grid =
        capture.scan.camera ? std::nullopt : derive_wall_frame(capture.scan).grid;
    if (!capture.scan.camera && !grid) return {};
    const std::size_t count = sequence.frames.size();
    const std::size_t num_shown = std::min(kMaxFrames, count);
    std::vector<ImagePanel> images;
    std::vector<float> values;
    for (std::size_t i = 0; i < num_shown; ++i) {
        const std::size_t frame = num_shown > 1 ? i * (count - 1) / (num_shown - 1) : 0;
        const core::Transient& transient = sequence.frames[frame];
        ImagePanel image =
            grid ? light_panel(capture, transient, *grid)
                 : gated_panel(*capture.scan.camera, transient, {0, transient.num_bins()});
        core::TimeAxis axis = capture.time_axis;
        axis.opl_start_m -= static_cast<double>(count - 1 - frame) * sequence.gate_step_m;
        image.title = fmt::format("Frame {}: {}", frame, axis_text(axis));
        image.value_label = unit_of(capture);
        values.insert(values.end(), image.values.begin(), image.values.end());
        images.push_back(std::move(image));
    }
    const Range range = light_range(values, kBrightestPixels);
    std::vector<Panel> panels;
    const bool is_faint = std::any_of(images.begin(), images.end(), [](const ImagePanel& image) {
        return image.value_scale == ValueScale::Gamma;
    });
    for (ImagePanel& image : images) {
        image.value_range = range;
        image.value_scale = is_faint ? ValueScale::Gamma : ValueScale::Linear;
        panels.emplace_back(std::move(image));
    }
    return panels;
}

}  // namespace

std::string encode_preview_png(const core::Capture& capture) {
    const core::PinholeCamera& camera = *capture.scan.camera;
    const ImagePanel panel =
        gated_panel(camera, capture.transient, {0, capture.transient.num_bins()});
    const double white = (*panel.value_range)[1];
    std::vector<Colour> colours;
    for (const float value : panel.values) {
        const double share = white > 0.0 ? std::clamp(double{value} / white, 0.0, 1.0) : 0.0;
        colours.push_back(colour_at(ColourMap::Grey, std::pow(share, 1.0 / kScreenGamma)));
    }
    const auto& [width, height] = camera.resolution;
    const int zoom = std::max(1, kPreviewWidth / width);
    Canvas canvas(zoom * width, zoom * height, {});
    canvas.image({0, 0, zoom * width, zoom * height}, width, height, colours);
    return canvas.encode_png();
}

std::vector<Panel> capture_panels(const core::Capture& capture) {
    std::vector<Panel> panels;
    if (capture.sequence) panels = film_strip(capture);
    if (panels.empty()) {
        panels = capture.scan.camera ? image_panels(capture) : scan_panels(capture);
    }
    const std::vector<Panel> velocities = velocity_panels(capture);
    panels.insert(panels.end(), velocities.begin(), velocities.end());
    return panels;
}

}  // namespace nlos
