// SPDX-License-Identifier: MIT
#include "renderer/film/pass_histogram.h"

#include <array>
#include <cmath>
#include <limits>

namespace renderer {

PassHistogram::PassHistogram(const core::HistogramAxes& axes, GateShape gate, int num_channels)
    : axis_(axes.time),
      gate_(TimeGate::of_axis(axes.time, gate)),
      values_(static_cast<std::size_t>(num_channels) *
                  static_cast<std::size_t>(axes.time.num_bins) +
              1),
      first_touched_(axes.time.num_bins) {
    if (axes.velocity) velocity_.emplace(*axes.velocity, axes.time.num_bins);
}

void PassHistogram::add(int channel, const OpticalPath& path, double value) {
    if (!std::isfinite(value) || !std::isfinite(path.opl_m)) {
        ++num_non_finite_;
        return;
    }
    if (gate_.shape != GateShape::Box) {
        add_to_bin(channel, 0, path.velocity_m_per_s, value * gate_.weight(path.opl_m));
    } else if (const auto bin = axis_.bin_of(path.opl_m)) {
        add_to_bin(channel, *bin, path.velocity_m_per_s, value);
    }
}

void PassHistogram::add_to_bin(int channel, int bin, double velocity_m_per_s, double value) {
    if (!std::isfinite(value) || std::isnan(velocity_m_per_s)) {
        ++num_non_finite_;
        return;
    }
    if (value == 0.0) return;
    first_touched_ = std::min(first_touched_, bin);
    last_touched_ = std::max(last_touched_, bin);
    values_[static_cast<std::size_t>(channel * axis_.num_bins + bin)] += value;
    if (velocity_) velocity_->add(velocity_m_per_s, bin, value);
}

void PassHistogram::add(int channel,
                        std::span<const double> opl_m,
                        std::span<const double> velocities,
                        std::span<const double> values) {
    // Short loops without branches, so that the compiler fills vector units.
    constexpr double kMax = std::numeric_limits<double>::max();
    const std::size_t size = values.size();
    int num_non_finite = 0;
    for (std::size_t i = 0; i < size; ++i) {
        num_non_finite += std::abs(values[i]) + std::abs(opl_m[i]) <= kMax ? 0 : 1;
    }
    if (gate_.shape != GateShape::Box || velocity_ || num_non_finite > 0) {
        for (std::size_t i = 0; i < size; ++i) {
            add(channel, {opl_m[i], velocity_ ? velocities[i] : 0.0}, values[i]);
        }
        return;
    }
    // As TimeAxis::bin_of(), for all at once; lengths outside the axis share one place.
    std::array<int, kMaxAtOnce> indices;
    const double start = axis_.opl_start_m;
    const double width = axis_.bin_width_m;
    const int num_bins = axis_.num_bins;
    const double end = num_bins;
    for (std::size_t i = 0; i < size; ++i) {
        double position = (opl_m[i] - start) / width;
        position = position >= 0.0 ? position : end;
        position = values[i] != 0.0 ? position : end;
        indices[i] = static_cast<int>(position < end ? position : end);
    }
    int lowest = num_bins;
    int highest = -1;
    for (std::size_t i = 0; i < size; ++i) {
        const int bin = indices[i];
        const int inside = bin < num_bins ? bin : -1;
        lowest = bin < lowest ? bin : lowest;
        highest = inside > highest ? inside : highest;
    }
    const int first = channel * num_bins;
    const int outside = static_cast<int>(values_.size()) - 1;
    for (std::size_t i = 0; i < size; ++i) {
        indices[i] = indices[i] < num_bins ? first + indices[i] : outside;
    }
    first_touched_ = std::min(first_touched_, lowest);
    last_touched_ = std::max(last_touched_, highest);
    // Neighbours often fall into the same bin, and such additions depend on each other; taking four
    // parts in turn breaks these chains.
    const std::size_t part = size / 4;
    for (std::size_t i = 0; i < part; ++i) {
        values_[static_cast<std::size_t>(indices[i])] += values[i];
        values_[static_cast<std::size_t>(indices[i + part])] += values[i + part];
        values_[static_cast<std::size_t>(indices[i + 2 * part])] += values[i + 2 * part];
        values_[static_cast<std::size_t>(indices[i + 3 * part])] += values[i + 3 * part];
    }
    for (std::size_t i = 4 * part; i < size; ++i) {
        values_[static_cast<std::size_t>(indices[i])] += values[i];
    }
}

}  // namespace renderer
