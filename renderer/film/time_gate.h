// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/velocity_axis.h"
#include "renderer/settings/render_settings.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace renderer {

/// The length of a path, and its rate of change as the vertices move with their surfaces.
///
/// The rate is the sum over segments of u . (v_end - v_start), u along the segment, since
/// d|r|/dt = r/|r| . dr/dt.
struct OpticalPath {
    double opl_m = 0.0;
    double velocity_m_per_s = 0.0;

    /// Appends a segment.
    ///
    /// offset   from its start to its end [m], not 0
    void add_segment(const core::Vec3& offset,
                     const core::Vec3& start_velocity,
                     const core::Vec3& end_velocity) {
        const double length = offset.norm();
        opl_m += length;
        velocity_m_per_s += offset.dot(end_velocity - start_velocity) / length;
    }
};

/// A bin, a shaped gate or all bins together: a weight of the path length with peak 1.
struct TimeGate {
    double start_m = 0.0;
    double width_m = 0.0;
    GateShape shape = GateShape::Box;

    static TimeGate of_bin(const core::TimeAxis& axis, int bin, GateShape shape) {
        return {axis.bin_begin_m(bin), axis.bin_width_m, shape};
    }
    /// shape   of an axis with one bin
    static TimeGate of_axis(const core::TimeAxis& axis, GateShape shape) {
        if (axis.num_bins == 1) return of_bin(axis, 0, shape);
        return {axis.opl_start_m, axis.opl_end_m() - axis.opl_start_m, GateShape::Box};
    }

    bool operator==(const TimeGate&) const = default;

    double weight(double opl_m) const {
        if (shape == GateShape::Box) return admits(opl_m) ? 1.0 : 0.0;
        const double offset = (opl_m - start_m) / width_m - 0.5;
        if (shape == GateShape::Tent) return std::max(0.0, 1.0 - std::abs(offset));
        return std::exp(-0.5 * offset * offset);
    }

    /// The lengths of positive weight; a Gaussian is cut off where it is below rounding.
    double begin_m() const { return start_m - overhang() * width_m; }
    double end_m() const { return start_m + (1.0 + overhang()) * width_m; }
    bool admits(double opl_m) const { return opl_m >= begin_m() && opl_m < end_m(); }

 private:
    double overhang() const {
        if (shape == GateShape::Box) return 0.0;
        return shape == GateShape::Tent ? 0.5 : 8.0;
    }
};

/// One bin of a velocity axis.
struct VelocityGate {
    core::VelocityAxis axis;
    int bin = 0;

    double start_m_per_s() const { return axis.bin_begin_m_per_s(bin); }
    bool contains(double velocity_m_per_s) const { return axis.bin_of(velocity_m_per_s) == bin; }
};

/// The gate of one reservoir: path lengths and, where they are resolved, velocities.
struct PathGate {
    TimeGate time;
    std::optional<VelocityGate> velocity;

    double weight(const OpticalPath& path) const {
        if (velocity && !velocity->contains(path.velocity_m_per_s)) return 0.0;
        return time.weight(path.opl_m);
    }

    /// Whether two gates of one scan admit the same paths.
    bool operator==(const PathGate& other) const {
        return time == other.time && velocity.has_value() == other.velocity.has_value() &&
               (!velocity || velocity->bin == other.velocity->bin);
    }
};

}  // namespace renderer
