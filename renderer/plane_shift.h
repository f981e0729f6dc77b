// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"
#include "renderer/shift_counts.h"

#include <optional>

namespace renderer {

/// An orthonormal frame of a plane.
struct PlaneFrame {
    core::Vec3 tangent1;
    core::Vec3 tangent2;
    core::Vec3 normal;
};

/// The two neighbours of a vertex, relative to one point near it [m].
struct Foci {
    core::Vec3 a;
    core::Vec3 y;
};

/// How the path length of a vertex changes: l' = ratio * l + offset_m.
struct LengthChange {
    double ratio = 1.0;     ///< S, width of the target's gate over that of the source's
    double offset_m = 0.0;  ///< (t_t - rest_t) - S (t_s - rest_s)

    LengthChange inverse() const { return {1.0 / ratio, -offset_m / ratio}; }
};

/// Where a plane's point goes, and by how much areas grow.
struct PlaneShift {
    core::Vec3 displacement;  ///< from the vertex [m]
    double jacobian = 0.0;    ///< dA'/dA
};

/// Moves a point within its plane so that its path length changes as asked, in closed form.
///
/// The points of a plane with path length tau form an ellipse; its affine image is a circle, and
/// the point keeps its angle on it, counted from the image of tangent1. The map is one-to-one,
/// defined wherever the target's ellipse exists, and needs no search.
///
/// source, target   foci relative to the point that moves
/// returns          nullopt with the reason in `trace`
/// throws           nothing
/// source           derived in plane_shift.cpp; the measure is that of [Pediredla2019]
std::optional<PlaneShift> shift_on_plane(const PlaneFrame& plane,
                                         const Foci& source,
                                         const Foci& target,
                                         const LengthChange& change,
                                         ShiftTrace& trace);

}  // namespace renderer
