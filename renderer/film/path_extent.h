// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

namespace renderer {

/// The length of a path, and its rate of change as the vertices move with their surfaces.
///
/// The rate is the sum over segments of u . (v_end - v_start), u along the segment, since
/// d|r|/dt = r/|r| . dr/dt.
struct PathExtent {
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

}  // namespace renderer
