// SPDX-License-Identifier: MIT
#include "nlos/pictures/light_images.h"

#include "nlos/pictures/image_layout.h"
#include "nlos/pictures/light_scale.h"

#include <fmt/core.h>

#include <limits>
#include <numeric>

namespace nlos {

std::string axis_text(const core::TimeAxis& axis) {
    return fmt::format("{:.4g} to {:.4g} m", axis.opl_start_m, axis.opl_end_m());
}

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
        if (seen[i] == 0) light[i] = std::numeric_limits<float>::quiet_NaN();
    }
    ImagePanel panel = wall_panel(grid, {light.begin(), light.end()});
    panel.title = capture.scan.pattern == core::ScanPattern::Exhaustive
                      ? "Light over the wall, all bins and lit points"
                      : "Light over the wall, all bins";
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

}  // namespace nlos
