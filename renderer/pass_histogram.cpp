// SPDX-License-Identifier: MIT
#include "renderer/pass_histogram.h"

#include <algorithm>
#include <cmath>

namespace renderer {

PassHistogram::PassHistogram(const core::TimeAxis& axis, GateShape gate, int num_channels)
    : axis_(axis),
      gate_(gate),
      values_(static_cast<std::size_t>(num_channels) * static_cast<std::size_t>(axis.num_bins)),
      is_touched_(static_cast<std::size_t>(axis.num_bins)) {}

void PassHistogram::add(int channel, double opl_m, double value) {
    if (!std::isfinite(value) || !std::isfinite(opl_m)) {
        ++num_non_finite_;
        return;
    }
    int bin = 0;
    const double weighted = value * gate_weight(opl_m, bin);
    if (weighted == 0.0) return;
    const auto index = static_cast<std::size_t>(bin);
    if (!is_touched_[index]) {
        is_touched_[index] = true;
        touched_.push_back(static_cast<std::uint32_t>(bin));
    }
    values_[static_cast<std::size_t>(channel * axis_.num_bins) + index] += weighted;
}

double PassHistogram::gate_weight(double opl_m, int& bin) const {
    if (gate_ == GateShape::Box) {
        const std::optional<int> found = axis_.bin_of(opl_m);
        bin = found.value_or(0);
        return found ? 1.0 : 0.0;
    }
    const double offset = (opl_m - axis_.bin_center_m(0)) / axis_.bin_width_m;
    if (gate_ == GateShape::Tent) return std::max(0.0, 1.0 - std::abs(offset));
    return std::exp(-0.5 * offset * offset);
}

}  // namespace renderer
