// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/time_axis.h"
#include "renderer/render_settings.h"

#include <cstdint>
#include <vector>

namespace renderer {

/// Collects the contributions of one pair during one pass, and remembers which bins it touched.
///
/// A channel is a bounce order, or channel 0 holds all of them.
class PassHistogram {
 public:
    PassHistogram(const core::TimeAxis& axis, GateShape gate, int num_channels);

    /// Adds a contribution of a path of length `opl_m`, weighted by the gate.
    void add(int channel, double opl_m, double value);

    /// Hands over what was collected and clears it: first `visit_value(channel * num_bins + bin,
    /// value)` for every channel of every touched bin, then `visit_total(bin, sum over channels)`.
    template <class VisitValue, class VisitTotal>
    void drain(VisitValue&& visit_value, VisitTotal&& visit_total) {
        const auto num_bins = static_cast<std::size_t>(axis_.num_bins);
        for (const std::uint32_t bin : touched_) {
            double total = 0.0;
            for (std::size_t i = bin; i < values_.size(); i += num_bins) {
                visit_value(i, values_[i]);
                total += values_[i];
                values_[i] = 0.0;
            }
            visit_total(std::size_t{bin}, total);
            is_touched_[bin] = false;
        }
        touched_.clear();
    }

    /// Contributions so far that were not finite numbers; they are left out of the bins.
    std::uint64_t num_non_finite() const { return num_non_finite_; }

 private:
    /// Bin and weight of a path length; weight 0 when it lies outside.
    double gate_weight(double opl_m, int& bin) const;

    core::TimeAxis axis_;
    GateShape gate_;
    std::vector<double> values_;  ///< [channel][bin]
    std::vector<std::uint32_t> touched_;
    std::vector<bool> is_touched_;
    std::uint64_t num_non_finite_ = 0;
};

}  // namespace renderer
