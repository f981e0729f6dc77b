// SPDX-License-Identifier: MIT
#include "nlos/pictures/animation.h"

#include "nlos/pictures/image_layout.h"
#include "nlos/pictures/light_scale.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

namespace nlos {
namespace {

constexpr double kBrightestOfAnimation = 0.001;  // of all values, drawn in the last colour

using Bins = std::array<std::size_t, 2>;  // first and one past the last

/// One scale for all: of light that is faint in any of them, one that shows it.
void share_scale(double brightest_fraction, std::vector<ImagePanel>& images) {
    std::vector<float> values;
    for (const ImagePanel& image : images) {
        values.insert(values.end(), image.values.begin(), image.values.end());
    }
    const std::array<double, 2> range = light_range(std::move(values), brightest_fraction);
    bool is_faint = false;
    for (ImagePanel& image : images) {
        is_faint = is_faint || image.value_scale == ValueScale::Gamma;
        image.value_range = range;
    }
    for (ImagePanel& image : images) {
        image.value_scale = is_faint ? ValueScale::Gamma : ValueScale::Linear;
    }
}

/// Light of bins [first, last) of every point of the wall.
ImagePanel wall_image(const core::Capture& capture,
                      const core::WallScan& scan,
                      const WallGrid& grid,
                      const Bins& bins) {
    std::vector<float> sums;
    for (std::size_t point = 0; point < grid.size[0] * grid.size[1]; ++point) {
        const std::size_t pair = pair_of(scan, point);
        const core::BinRange observed = capture.observed_range(pair);
        float sum = 0.0F;
        bool is_seen = false;
        for (std::size_t bin = bins[0]; bin < bins[1]; ++bin) {
            is_seen = is_seen || observed.holds(static_cast<int>(bin));
            sum += capture.transient.histogram(pair)[bin];
        }
        sums.push_back(is_seen ? sum : std::numeric_limits<float>::quiet_NaN());
    }
    return wall_panel(grid, sums);
}

/// What draws bins of a capture's light. The capture has to be a picture.
std::function<ImagePanel(const Bins&)> bin_drawer(const core::Capture& capture) {
    using Draw = std::function<ImagePanel(const Bins&)>;
    return capture.scan.visit(
        [&](const core::WallScan& scan) -> Draw {
            return [&, grid = *derive_wall_frame(scan).grid](const Bins& bins) {
                return wall_image(capture, scan, grid, bins);
            };
        },
        [&](const core::ImageScan& image) -> Draw {
            return [&](const Bins& bins) {
                return gated_panel(image.camera, capture.transient, bins);
            };
        });
}

/// What draws all light of a frame. The capture has to be a picture.
std::function<ImagePanel(const core::Transient&)> frame_drawer(const core::Capture& capture) {
    using Draw = std::function<ImagePanel(const core::Transient&)>;
    return capture.scan.visit(
        [&](const core::WallScan& scan) -> Draw {
            return [&, grid = *derive_wall_frame(scan).grid](const core::Transient& frame) {
                return light_panel(capture, frame, grid);
            };
        },
        [](const core::ImageScan& image) -> Draw {
            return [&](const core::Transient& frame) {
                return gated_panel(image.camera, frame, {0, frame.num_bins()});
            };
        });
}

std::string time_text(const core::Capture& capture, const Bins& bins) {
    const double middle_m =
        capture.time_axis.bin_begin_m(0.5 * static_cast<double>(bins[0] + bins[1]));
    return fmt::format(
        "Path length {:.3f} m, {:.3f} ns", middle_m, 1e9 * middle_m / core::kSpeedOfLight);
}

std::vector<ImagePanel> bin_panels(const core::Capture& capture, std::size_t most) {
    const auto draw = bin_drawer(capture);
    const auto [first, last] = shown_bins(mean_transient(capture));
    const std::size_t per_frame = (last - first + most - 1) / most;
    std::vector<ImagePanel> images;
    for (std::size_t begin = first; begin < last; begin += per_frame) {
        const std::array bins{begin, std::min(last, begin + per_frame)};
        ImagePanel image = draw(bins);
        image.title = time_text(capture, bins);
        image.value_label = per_frame == 1 ? light_per_bin_label(capture) : light_label(capture);
        image.value_scale = ValueScale::Gamma;
        images.push_back(std::move(image));
    }
    share_scale(kBrightestOfAnimation, images);
    return images;
}

}  // namespace

std::string axis_text(const core::TimeAxis& axis) {
    return fmt::format("{:.4g} to {:.4g} m", axis.opl_start_m, axis.opl_end_m());
}

ImagePanel light_panel(const core::Capture& capture,
                       const core::Transient& transient,
                       const WallGrid& grid) {
    const core::WallScan& scan = capture.scan.wall();
    std::vector<double> light(grid.size[0] * grid.size[1], 0.0);
    std::vector<int> seen(light.size(), 0);  // bins
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        const std::size_t point = point_of(scan, pair);
        for (const float value : transient.histogram(pair)) light[point] += value;
        seen[point] += capture.observed_range(pair).size();
    }
    for (std::size_t i = 0; i < light.size(); ++i) {
        if (seen[i] == 0) light[i] = std::numeric_limits<float>::quiet_NaN();
    }
    ImagePanel panel = wall_panel(grid, {light.begin(), light.end()});
    panel.title = "Light over the wall, all bins";
    if (scan.is_exhaustive()) {
        panel.title += shows_lit_points(scan) ? " and sensing points" : " and lit points";
    }
    panel.value_label = light_label(capture);
    return panel;
}

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

std::vector<ImagePanel> sequence_panels(const core::Capture& capture, std::size_t most) {
    const core::FrameSequence& sequence = *capture.sequence;
    if (!is_picture(capture.scan)) return {};
    const auto draw = frame_drawer(capture);
    const std::size_t count = sequence.frames.size();
    const std::size_t num_shown = std::min(most, count);
    std::vector<ImagePanel> images;
    for (std::size_t i = 0; i < num_shown; ++i) {
        const std::size_t frame = num_shown > 1 ? i * (count - 1) / (num_shown - 1) : 0;
        ImagePanel image = draw(sequence.frames[frame]);
        core::TimeAxis axis = capture.time_axis;
        axis.opl_start_m -= static_cast<double>(count - 1 - frame) * sequence.gate_step_m;
        image.title = fmt::format("Frame {}: {}", frame, axis_text(axis));
        image.value_label = light_label(capture);
        images.push_back(std::move(image));
    }
    share_scale(kBrightestPixels, images);
    return images;
}

std::vector<ImagePanel> animation_panels(const core::Capture& capture, std::size_t most) {
    if (!is_picture(capture.scan)) {
        throw core::Error("film", "found a list of points", "must be a grid of points or a camera");
    }
    if (capture.sequence) return sequence_panels(capture, most);
    if (capture.transient.num_bins() < 2) {
        throw core::Error("film", "found one time bin", "must be several, or a sequence of frames");
    }
    return bin_panels(capture, most);
}

}  // namespace nlos
