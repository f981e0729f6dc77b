// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/velocity_axis.h"
#include "renderer/film/time_gate.h"
#include "renderer/settings/render_settings.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace renderer {

/// Collects the contributions of one pair during one pass by path velocity. Most bins stay empty,
/// above all where velocities are resolved in time, so those that are not are listed.
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
        const auto index =
            static_cast<std::size_t>(axis_.with_time ? *bin * num_time_bins_ + time_bin : *bin);
        if (values_[index] == 0.0) touched_.push_back(index);
        values_[index] += value;
    }

    /// As PassHistogram::drain() for a single channel.
    template <class VisitValues, class VisitTotals>
    void drain(VisitValues&& visit_values, VisitTotals&& visit_totals) {
        for (const std::size_t index : touched_) {
            const std::span<const double> value{values_.data() + index, 1};
            visit_values(index, value);
            visit_totals(index, value);
            values_[index] = 0.0;
        }
        touched_.clear();
    }

 private:
    core::VelocityAxis axis_;
    int num_time_bins_;
    std::vector<double> values_;
    std::vector<std::size_t> touched_;
};

/// Collects the contributions of one pair during one pass, and remembers which bins it touched.
///
/// A channel is a bounce order, or channel 0 holds all of them. With a velocity axis, contributions
/// are also collected by path velocity.
class PassHistogram {
 public:
    PassHistogram(const core::HistogramAxes& axes, GateShape gate, int num_channels);

    /// Adds a contribution of a path, weighted by the gate.
    void add(int channel, const OpticalPath& path, double value);
    /// Adds a contribution that is already weighted by the gate to a bin.
    void add_to_bin(int channel, int bin, double velocity_m_per_s, double value);
    /// Path lengths that it does not admit count nowhere.
    const TimeGate& gate() const { return gate_; }
    /// Adds many contributions; those of 0 are left out.
    ///
    /// opl_m, values   one entry per path, at most kMaxAtOnce
    /// velocities      [m/s] likewise; not looked at unless resolves_velocity()
    void add(int channel,
             std::span<const double> opl_m,
             std::span<const double> velocities,
             std::span<const double> values);
    static constexpr std::size_t kMaxAtOnce = 128;
    bool resolves_velocity() const { return velocity_.has_value(); }
    /// What was collected by velocity; only if resolves_velocity().
    PassVelocityHistogram& velocity() { return *velocity_; }

    /// Hands over what was collected and clears it, for a range that holds all touched bins: first
    /// `visit_values(channel * num_bins + first bin, values)` for every channel, then
    /// `visit_totals(first bin, sums over channels)`; the last arguments are spans.
    template <class VisitValues, class VisitTotals>
    void drain(VisitValues&& visit_values, VisitTotals&& visit_totals) {
        if (last_touched_ < 0) return;
        const auto num_bins = static_cast<std::size_t>(axis_.num_bins);
        const auto first = static_cast<std::size_t>(first_touched_);
        const auto count = static_cast<std::size_t>(last_touched_) - first + 1;
        const std::span<double> totals{values_.data() + first, count};
        visit_values(first, std::span<const double>(totals));
        for (std::size_t begin = num_bins; begin + num_bins < values_.size(); begin += num_bins) {
            const std::span<double> row{values_.data() + begin + first, count};
            visit_values(begin + first, std::span<const double>(row));
            for (std::size_t i = 0; i < count; ++i) totals[i] += row[i];
            std::fill(row.begin(), row.end(), 0.0);
        }
        visit_totals(first, std::span<const double>(totals));
        std::fill(totals.begin(), totals.end(), 0.0);
        first_touched_ = axis_.num_bins;
        last_touched_ = -1;
    }

    /// Contributions so far that were not finite; they are left out of the bins.
    std::uint64_t num_non_finite() const { return num_non_finite_; }

 private:
    core::TimeAxis axis_;
    TimeGate gate_;               ///< of all bins
    std::vector<double> values_;  ///< [channel][bin], and one for what lies outside the axis
    int first_touched_;
    int last_touched_ = -1;
    std::optional<PassVelocityHistogram> velocity_;
    std::uint64_t num_non_finite_ = 0;
};

}  // namespace renderer
