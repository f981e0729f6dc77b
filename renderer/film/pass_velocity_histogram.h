// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/velocity_axis.h"

#include <cstddef>
#include <span>
#include <vector>

namespace renderer {

/// Collects the contributions of one pair during one pass by path velocity, see PassHistogram.
/// Most bins stay empty, those of velocity and time together most of all: it lists the others.
class PassVelocityHistogram {
 public:
    PassVelocityHistogram(const core::VelocityAxis& axis, int num_time_bins)
        : axis_(axis),
          num_time_bins_(num_time_bins),
          values_(static_cast<std::size_t>(axis.num_values(num_time_bins))) {}

    /// Adds a contribution; what lies outside the axis is left out.
    void add(double velocity_m_per_s, int time_bin, double value) {
        const auto bin = axis_.bin_of(velocity_m_per_s);
        if (!bin) return;
        const auto place =
            static_cast<std::size_t>(axis_.with_time ? *bin * num_time_bins_ + time_bin : *bin);
        if (values_[place] == 0.0) touched_.push_back(place);
        values_[place] += value;
    }

    /// As PassHistogram::drain() for a single channel.
    template <class VisitValues, class VisitTotals>
    void drain(VisitValues&& visit_values, VisitTotals&& visit_totals) {
        for (const std::size_t place : touched_) {
            const std::span<const double> value{values_.data() + place, 1};
            visit_values(place, value);
            visit_totals(place, value);
            values_[place] = 0.0;
        }
        touched_.clear();
    }

 private:
    core::VelocityAxis axis_;
    int num_time_bins_;
    std::vector<double> values_;
    std::vector<std::size_t> touched_;
};

}  // namespace renderer
