// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/time_axis.h"
#include "renderer/core/capture/transient.h"
#include "renderer/core/types.h"

#include <optional>
#include <string>

namespace core {

/// Bins of path velocity, the rate at which a path's length changes [m/s]: bin i covers
/// [start + i w, start + (i+1) w). Positive: the path grows longer.
struct VelocityAxis {
    double start_m_per_s = -10.0;
    double bin_width_m_per_s = 0.5;
    int num_bins = 40;
    bool with_time = false;
    double carrier_hz = 193e12;

    double end_m_per_s() const { return start_m_per_s + num_bins * bin_width_m_per_s; }
    double bin_begin_m_per_s(double bin) const { return start_m_per_s + bin * bin_width_m_per_s; }
    double bin_center_m_per_s(double bin) const { return bin_begin_m_per_s(bin + 0.5); }

    /// The bin that holds a velocity, or nothing when it lies outside the axis.
    std::optional<int> bin_of(double velocity_m_per_s) const {
        const double position = (velocity_m_per_s - start_m_per_s) / bin_width_m_per_s;
        if (!(position >= 0.0) || !(position < num_bins)) return std::nullopt;
        return static_cast<int>(position);
    }

    /// Bins of a pair's histogram: one per velocity, or per velocity and time bin, time fastest.
    int num_values(int num_time_bins) const {
        return with_time ? num_bins * num_time_bins : num_bins;
    }
};

template <class Visitor>
void for_each_field(VelocityAxis& axis, Visitor&& visit) {
    visit("start_m_per_s",
          axis.start_m_per_s,
          Ranged{"path velocity at the start of bin 0 [m/s]", {}});
    visit("bin_width_m_per_s",
          axis.bin_width_m_per_s,
          above(0, "width of a bin in path velocity [m/s]"));
    visit("num_bins", axis.num_bins, at_least(1, "number of bins"));
    visit("with_time", axis.with_time, "resolve velocity and path length together");
    visit("carrier_hz",
          axis.carrier_hz,
          above(0, "frequency f0 for which shifts -f0 u/c are given [Hz]"));
}

/// Throws Error unless the axis has at least one bin of positive width and a positive carrier.
inline void validate(const VelocityAxis& axis, const std::string& where) {
    check_ranges(axis, where);
}

/// Doppler shift of light, or of its modulation, along a path whose length changes at a rate:
/// -f0 u/c, to first order in u/c.
///
/// carrier_hz         f0
/// velocity_m_per_s   u, the path velocity
inline double frequency_shift_hz(double carrier_hz, double velocity_m_per_s) {
    return -carrier_hz * velocity_m_per_s / kSpeedOfLight;
}

/// The axes of what is measured per pair.
struct HistogramAxes {
    TimeAxis time;
    std::optional<VelocityAxis> velocity;  ///< nothing: velocities are not resolved

    // Most measurements have a time axis alone.
    HistogramAxes() = default;
    HistogramAxes(const TimeAxis& time_axis) : time(time_axis) {}  // NOLINT: meant to convert
    HistogramAxes(const TimeAxis& time_axis, const std::optional<VelocityAxis>& velocity_axis)
        : time(time_axis), velocity(velocity_axis) {}
};

/// Power by path velocity.
struct VelocityHistogram {
    VelocityAxis axis;
    Transient values;                   ///< [pair][velocity] or [pair][velocity][time]
    std::optional<Transient> variance;  ///< of each value, when known
};

}  // namespace core
