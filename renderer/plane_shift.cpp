// SPDX-License-Identifier: MIT
#include "renderer/plane_shift.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

// Rounding grows near the segment between the foci; what misses its length is not taken.
constexpr double kLengthTolerance = 1e-9;  ///< of the length, and of a metre
// Near the tangent point the circle's radius is the root of a difference: at this size the rounding
// of the Jacobian reaches 1e-8. The map on smaller circles is left out on both sides.
constexpr double kSmallestCircle = 1e-4;

}  // namespace

std::optional<PlaneShift> shift_on_plane(const Facet& plane,
                                         const FocusPair& source,
                                         const FocusPair& target,
                                         const LengthChange& change,
                                         ShiftTrace& trace) {
    Facet local = plane;
    local.corner.setZero();
    const double length = source.a.norm() + source.b.norm();
    const auto from = EllipsoidSection::cut(source, length, local);
    if (!from || from->circle_radius() < kSmallestCircle) {
        return trace.reject(ShiftRejection::Degenerate);
    }
    const double new_length = change.ratio * length + change.offset_m;
    const auto to = EllipsoidSection::cut(target, new_length, local);
    if (!to) return trace.reject(ShiftRejection::BelowMinimum);

    if (to->circle_radius() < kSmallestCircle) return trace.reject(ShiftRejection::Degenerate);

    const core::Vec2 angle = from->angle_of(core::Vec3::Zero());
    PlaneShift shift;
    shift.displacement = to->point(angle);
    const double residual = target.opl_m(shift.displacement) - new_length;
    if (!(std::abs(residual) <= kLengthTolerance * std::min(1.0, new_length))) {
        return trace.reject(ShiftRejection::NotConverged);
    }
    shift.jacobian = change.ratio * to->area_per_opl_and_angle(shift.displacement, angle) /
                     from->area_per_opl_and_angle(core::Vec3::Zero(), angle);
    if (!(shift.jacobian > 0.0) || !std::isfinite(shift.jacobian)) {
        return trace.reject(ShiftRejection::Degenerate);
    }
    return shift;
}

}  // namespace renderer
