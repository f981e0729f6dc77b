// SPDX-License-Identifier: MIT
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

// Light that moves is a small part of most scenes' light: powers are drawn in decibels over this
// fraction of all.
constexpr double kFloor = 1e-6;
constexpr const char* kPowerLabel = "light [dB over 10⁻⁶ of all]";

using Range = std::array<double, 2>;

double decibels(double fraction) {
    return fraction > kFloor ? 10.0 * std::log10(fraction / kFloor) : 0.0;
}

/// The sum over all pairs, value by value.
std::vector<double> sum_over_pairs(const core::Transient& values) {
    std::vector<double> sums(values.num_bins());
    for (std::size_t pair = 0; pair < values.num_pairs(); ++pair) {
        const auto histogram = values.histogram(pair);
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += double{histogram[i]};
    }
    return sums;
}

double total_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Values per bin of velocity.
std::size_t stride_of(const core::VelocityHistogram& velocity) {
    return velocity.values.num_bins() / static_cast<std::size_t>(velocity.axis.num_bins);
}

/// The mean path velocity of the light of every pair; NaN where there is none.
std::vector<float> mean_velocities(const core::VelocityHistogram& velocity) {
    std::vector<float> means;
    const std::size_t stride = stride_of(velocity);
    for (std::size_t pair = 0; pair < velocity.values.num_pairs(); ++pair) {
        const auto histogram = velocity.values.histogram(pair);
        double power = 0.0;
        double moment = 0.0;
        for (std::size_t i = 0; i < histogram.size(); ++i) {
            const auto bin = static_cast<double>(i / stride);
            power += double{histogram[i]};
            moment += double{histogram[i]} * velocity.axis.bin_center_m_per_s(bin);
        }
        means.push_back(power > 0.0 ? static_cast<float>(moment / power)
                                    : std::numeric_limits<float>::quiet_NaN());
    }
    return means;
}

/// Equally far to both sides, so that white is 0.
Range symmetric_range(const std::vector<float>& values) {
    float largest = 0.0F;
    for (const float value : values) {
        if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
    }
    return {-double{largest}, double{largest}};
}

ImagePanel velocity_image(const core::Scan& scan, const core::VelocityHistogram& velocity) {
    const std::vector<float> means = mean_velocities(velocity);
    ImagePanel panel = scan.visit(
        [&](const core::WallScan& wall) {
            return wall_panel(*derive_wall_frame(wall).grid, means);
        },
        [&](const core::ImageScan& image) { return camera_panel(image.camera, means); });
    panel.title = "Mean path velocity";
    panel.value_label = "path velocity [m/s]";
    panel.colour_map = ColourMap::Diverging;
    panel.value_range = symmetric_range(panel.values);
    return panel;
}

std::string hertz_text(double frequency_hz) {
    double scale = 1.0;
    std::string prefix;
    for (const char* next : {"k", "M", "G", "T"}) {
        if (std::abs(frequency_hz) < 1e3 * scale) break;
        scale *= 1e3;
        prefix = next;
    }
    return fmt::format("{:.4g} {}Hz", frequency_hz / scale, prefix);
}

Plot spectrum_plot(const core::VelocityHistogram& velocity) {
    const core::VelocityAxis& axis = velocity.axis;
    const std::vector<double> sums = sum_over_pairs(velocity.values);
    const double total = total_of(sums);
    const std::size_t stride = stride_of(velocity);
    Plot plot = area_plot(fmt::format("Spectrum; 1 m/s is {} at {}",
                                      hertz_text(core::frequency_shift_hz(axis.carrier_hz, 1.0)),
                                      hertz_text(axis.carrier_hz)),
                          "path velocity [m/s]",
                          kPowerLabel);
    for (std::size_t bin = 0; bin * stride < sums.size(); ++bin) {
        double power = 0.0;
        for (std::size_t i = bin * stride; i < (bin + 1) * stride; ++i) power += sums[i];
        const double fraction = decibels(total > 0.0 ? power / total : 0.0);
        // Both ends, so that the curve has the bins' steps.
        for (const std::size_t end : {bin, bin + 1}) {
            plot.lines.front().add(axis.bin_begin_m_per_s(static_cast<double>(end)), fraction);
        }
    }
    return plot;
}

ImagePanel velocity_over_time(const core::TimeAxis& time, const core::VelocityHistogram& velocity) {
    const std::vector<double> sums = sum_over_pairs(velocity.values);
    const double total = total_of(sums);
    const std::size_t stride = stride_of(velocity);
    ImagePanel panel = image_of(sums.size() / stride, stride, [&](std::size_t v, std::size_t t) {
        return decibels(total > 0.0 ? sums[v * stride + t] / total : 0.0);
    });
    panel.title = "Path velocity and path length";
    panel.x_range = {velocity.axis.start_m_per_s, velocity.axis.end_m_per_s()};
    panel.y_range = {time.opl_start_m, time.opl_end_m()};
    panel.x_label = "path velocity [m/s]";
    panel.y_label = "path length [m]";
    panel.y_direction = AxisDirection::Reversed;
    panel.value_label = kPowerLabel;
    panel.value_range = {0.0, decibels(1.0)};
    panel.aspect = AspectRatio::Free;
    return panel;
}

}  // namespace

std::vector<Panel> velocity_panels(const core::Capture& capture) {
    std::vector<Panel> panels;
    if (!capture.velocity) return panels;
    if (is_picture(capture.scan) && capture.scan.pattern() != core::ScanPattern::Exhaustive) {
        panels.emplace_back(velocity_image(capture.scan, *capture.velocity));
    }
    panels.emplace_back(spectrum_plot(*capture.velocity));
    if (capture.velocity->axis.with_time && capture.time_axis.num_bins > 1) {
        panels.emplace_back(velocity_over_time(capture.time_axis, *capture.velocity));
    }
    return panels;
}

}  // namespace nlos
