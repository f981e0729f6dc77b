// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/velocity_axis.h"
#include "renderer/film/path_extent.h"
#include "renderer/film/time_gate.h"

#include <optional>

namespace renderer {

/// One bin of a velocity axis.
struct VelocityGate {
    core::VelocityAxis axis;
    int bin = 0;

    double start_m_per_s() const { return axis.bin_begin_m_per_s(bin); }
    bool contains(double velocity_m_per_s) const { return axis.bin_of(velocity_m_per_s) == bin; }
};

/// What one reservoir admits: lengths and, when these are resolved, velocities.
struct PathGate {
    TimeGate time;
    std::optional<VelocityGate> velocity;

    double weight(const PathExtent& path) const {
        if (velocity && !velocity->contains(path.velocity_m_per_s)) return 0.0;
        return time.weight(path.opl_m);
    }

    /// Whether two gates of one measurement admit the same.
    bool operator==(const PathGate& other) const {
        return time == other.time && velocity.has_value() == other.velocity.has_value() &&
               (!velocity || velocity->bin == other.velocity->bin);
    }
};

}  // namespace renderer
