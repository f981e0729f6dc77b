// SPDX-License-Identifier: MIT
#include "apps/bench/render/comparison_pictures.h"

#include "nlos/pictures/image_layout.h"
#include "nlos/pictures/light_scale.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace apps {
namespace {

using nlos::ImagePanel;
using nlos::Panel;

constexpr double kBrightShare = 0.01;  ///< of the values of maps, drawn in the last colour
constexpr std::size_t kBlock = 4;      ///< pixels either way, over which differences are averaged

ImagePanel image_panel(const core::PinholeCamera& camera,
                       const std::string& title,
                       const std::vector<float>& values) {
    ImagePanel panel = nlos::camera_panel(camera, values);
    panel.title = title;
    panel.x_label.clear();
    panel.y_label.clear();
    return panel;
}

double bright_value(std::vector<float> values) {
    const auto rank =
        static_cast<std::ptrdiff_t>((1.0 - kBrightShare) * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    return double{values[static_cast<std::size_t>(rank)]};
}

// Means of blocks of pixels, at every one of them.
std::vector<float> block_means(const core::PinholeCamera& camera,
                               const std::vector<float>& values) {
    std::vector<float> means(values.size());
    const std::size_t height = camera.height();
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t x0 = i / height / kBlock * kBlock;
        const std::size_t y0 = i % height / kBlock * kBlock;
        double sum = 0.0;
        double count = 0.0;
        for (std::size_t x = x0; x < std::min(camera.width(), x0 + kBlock); ++x) {
            for (std::size_t y = y0; y < std::min(height, y0 + kBlock); ++y) {
                sum += double{values[x * height + y]};
                count += 1.0;
            }
        }
        means[i] = static_cast<float>(sum / count);
    }
    return means;
}

// One bin of every pixel.
std::vector<float> bin_of(const core::Transient& transient, std::size_t bin) {
    std::vector<float> values;
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        values.push_back(transient.histogram(pair)[bin]);
    }
    return values;
}

}  // namespace

std::vector<Panel> error_panels(const Comparison& comparison) {
    const core::PinholeCamera& camera = comparison.camera;
    ImagePanel truth =
        image_panel(camera, "Reference, last frame", bin_of(comparison.references[0].back(), 0));
    truth.value_range = {0.0, bright_value(truth.values)};
    truth.value_label = nlos::kRenderedRadiance;
    std::vector<Panel> panels{truth};
    std::vector<float> all;
    for (const MethodComparison& method : comparison.methods) {
        all.insert(all.end(), method.error_map.begin(), method.error_map.end());
    }
    const double top = bright_value(all);
    for (const MethodComparison& method : comparison.methods) {
        ImagePanel panel =
            image_panel(camera,
                        fmt::format("{}: relMSE {:.3g}", method.method, method.trimmed_rel_mse),
                        method.error_map);
        panel.value_range = {0.0, top};
        panel.value_label = "mean |error| / mean radiance";
        panel.colour_map = nlos::ColourMap::Viridis;
        panels.emplace_back(panel);
    }
    const MethodComparison& first = comparison.methods[0];
    const MethodComparison& second = comparison.methods[1];
    std::vector<float> difference = first.error_map;
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= second.error_map[i];
    ImagePanel panel = image_panel(
        camera,
        fmt::format("Error of {} − {}, {} pixels", first.method, second.method, kBlock * kBlock),
        block_means(camera, difference));
    panel.value_range = {-0.5 * top, 0.5 * top};
    panel.value_label = "red: " + second.method + " is better";
    panel.colour_map = nlos::ColourMap::Diverging;
    panels.emplace_back(panel);
    return panels;
}

std::vector<Panel> progress_panels(const Comparison& comparison) {
    const core::Transient& truth = comparison.references[0].back();
    std::vector<double> sums(truth.num_bins());
    for (std::size_t i = 0; i < truth.values().size(); ++i) {
        sums[i % sums.size()] += double{truth.values()[i]};
    }
    const auto bin =
        static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
    const std::vector<float> wanted = bin_of(truth, bin);
    const double top = bright_value(wanted);
    std::vector<Panel> panels;
    const auto add = [&](const std::string& title, const std::vector<float>& values) {
        ImagePanel panel = image_panel(comparison.camera, title, values);
        panel.value_range = {0.0, top};
        panels.emplace_back(panel);
    };
    for (const MethodComparison& method : comparison.methods) {
        for (std::size_t frame = 1; frame <= method.frames.size(); frame *= 2) {
            add(fmt::format("{}, frame {}: relMSE {:.2g}",
                            method.method,
                            frame,
                            method.rel_mse_of_frames[frame - 1]),
                bin_of(method.frames[frame - 1], bin));
        }
        add("reference", wanted);
    }
    return panels;
}

Plot progress_plot(const Comparison& comparison) {
    Plot plot{"Equal time per frame, " + comparison.scene, "frame", "relative MSE", {}};
    for (const MethodComparison& method : comparison.methods) {
        PlotLine& line = plot.lines.emplace_back();
        line.title = method.method;
        for (std::size_t f = 0; f < method.rel_mse_of_frames.size(); ++f) {
            line.x.push_back(static_cast<double>(f + 1));
            line.y.push_back(std::max(1e-9, method.rel_mse_of_frames[f]));
        }
    }
    return plot;
}

}  // namespace apps
