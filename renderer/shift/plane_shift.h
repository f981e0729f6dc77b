// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"
#include "renderer/geometry/ellipsoid.h"
#include "renderer/shift/shift_counts.h"

#include <optional>

namespace renderer {

/// How the path length of a vertex changes: l' = ratio * l + offset_m.
struct ConstraintChange {
    double ratio = 1.0;     ///< S, width of the target's gate over that of the source's
    double offset_m = 0.0;  ///< (t_t - rest_t) - S (t_s - rest_s)

    ConstraintChange inverse() const { return {1.0 / ratio, -offset_m / ratio}; }
};

/// The displacement of a point within a plane, and the change of areas.
struct PlaneShift {
    core::Vec3 displacement;  ///< from the vertex [m]
    double jacobian = 0.0;    ///< dA'/dA
};

/// Moves a point within its plane so that its path length changes as required, in closed form.
///
/// The point keeps its angle theta on the closed curve of its length (EllipsoidSection): the map is
/// one-to-one, defined wherever the target's curve exists, and needs no iteration.
/// With dA = K dtau dtheta on either side and dtau' = S dtau: dA'/dA = S K'/K.
///
/// plane            through the point: normal, and edge1 as the direction of theta = 0
/// source, target   foci relative to the point
/// rounding_m       of the coordinates [m]
/// returns          nullopt with the reason in `trace`
/// throws           nothing
std::optional<PlaneShift> shift_on_plane(const Facet& plane,
                                         const FocusPair& source,
                                         const FocusPair& target,
                                         const ConstraintChange& change,
                                         double rounding_m,
                                         ShiftTrace& trace);

}  // namespace renderer
