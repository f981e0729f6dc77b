// SPDX-License-Identifier: MIT
#include "nlos/pictures/light_scale.h"

#include "renderer/core/statistics.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr double kQuietFraction = 0.002;  // of all light, left out at either end of the axis
constexpr double kShownMargin = 0.02;     // of the axis, kept around what is shown

bool is_rendered(const core::Capture& capture) {
    return capture.scene_info->contains("estimator");
}

}  // namespace

std::string light_label(const core::Capture& capture) {
    if (capture.unit == core::TransientUnit::Counts) return "counts";
    return is_rendered(capture) ? kRenderedRadiance : "radiance";
}

std::string light_per_bin_label(const core::Capture& capture) {
    if (capture.unit == core::TransientUnit::Counts) return "counts per bin";
    return is_rendered(capture) ? kRenderedRadiancePerBin : "radiance per bin";
}

bool shows_lit_points(const core::WallScan& scan) {
    return &scan.scanned_points() == &scan.illumination;
}

std::size_t pair_of(const core::WallScan& scan, std::size_t point) {
    if (scan.pattern != core::ScanPattern::Exhaustive) return point;
    const std::size_t num_sensing = scan.sensing.size();
    return shows_lit_points(scan) ? point * num_sensing + num_sensing / 2
                                  : scan.illumination.size() / 2 * num_sensing + point;
}

std::size_t point_of(const core::WallScan& scan, std::size_t pair) {
    return shows_lit_points(scan) ? scan.illumination_index(pair) : scan.sensing_index(pair);
}

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

std::array<std::size_t, 2> shown_bins(const std::vector<double>& mean) {
    double total = 0.0;
    for (const double value : mean) total += std::max(0.0, value);
    if (!(total > 0.0)) return {0, mean.size()};
    std::size_t first = mean.size();
    std::size_t last = 0;
    double sum = 0.0;
    for (std::size_t bin = 0; bin < mean.size(); ++bin) {
        sum += std::max(0.0, mean[bin]);
        if (first == mean.size() && sum > kQuietFraction * total) first = bin;
        if (sum <= (1.0 - kQuietFraction) * total) last = bin + 1;
    }
    const auto margin =
        static_cast<std::size_t>(std::ceil(kShownMargin * static_cast<double>(mean.size())));
    return {first > margin ? first - margin : 0, std::min(mean.size(), last + 1 + margin)};
}

std::array<double, 2> light_range(std::vector<float> values, double brightest_fraction) {
    std::erase_if(values, [](float value) { return std::isnan(value); });
    if (values.empty()) return {0.0, 0.0};
    const float bright = core::quantile(values, 1.0 - brightest_fraction);
    // A gate may hold so little that the fraction is all of it.
    const float top = bright > 0.0F ? bright : *std::max_element(values.begin(), values.end());
    return {0.0, double{top}};
}

void choose_scale(ImagePanel& panel) {
    constexpr double kFaint = 0.1;  // of the range's top: the middle of what is lit
    std::vector<float> lit;
    for (const float value : panel.values) {
        if (value > 0.0F) lit.push_back(value);
    }
    if (lit.empty()) return;
    if (core::upper_median(std::move(lit)) < kFaint * (*panel.value_range)[1])
        panel.value_scale = ValueScale::Gamma;
}

}  // namespace nlos
