// SPDX-License-Identifier: MIT
#include "renderer/shift/plane_shift.h"

#include "renderer/shift/shift_solver.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

// One end of the shift: the curve of points with its path length.
struct PlaneEnd {
    std::optional<EllipsoidSection> section;
    double length = 0.0;
    double flatness = 0.0;  ///< (shorter axis/longer axis)^2 of the ellipsoid

    PlaneEnd(const FocusPair& foci, double length_m, const Facet& plane)
        : section(EllipsoidSection::cut(foci, length_m, plane)),
          length(length_m),
          flatness(1.0 - (foci.b - foci.a).squaredNorm() / (length_m * length_m)) {}

    // The flatness, and the radius of the circle where the ellipsoid touches the plane, are square
    // roots of differences; where either is small, rounding shows in the Jacobian. On a thin
    // ellipse the angle depends on the shorter axis, and the Jacobian varies over angles of the
    // ratio of the axes. Such ends are rejected on both sides of a shift, like those that the
    // solver cannot resolve.
    bool is_resolved(double segment_a, double segment_b, double rounding_m) const {
        const double radius = section->circle_radius();
        const double shorter = std::min(segment_a, segment_b);
        return radius * radius * std::sqrt(flatness) > kTinyDeterminant &&
               flatness > kTinyDeterminant && shorter > kShortestSegment * length &&
               shorter * radius * radius * flatness > kFeltRoundings * rounding_m;
    }
};

}  // namespace

std::optional<PlaneShift> shift_on_plane(const Facet& plane,
                                         const FocusPair& source,
                                         const FocusPair& target,
                                         const ConstraintChange& change,
                                         double rounding_m,
                                         ShiftTrace& trace) {
    Facet local = plane;
    local.corner.setZero();
    const double segment_a = source.a.norm();
    const double segment_b = source.b.norm();
    const PlaneEnd from(source, segment_a + segment_b, local);
    if (!from.section || !from.is_resolved(segment_a, segment_b, rounding_m)) {
        return trace.reject(ShiftRejection::Degenerate);
    }
    const PlaneEnd to(target, change.ratio * from.length + change.offset_m, local);
    if (!to.section) return trace.reject(ShiftRejection::BelowMinimum);

    const core::Vec2 angle = from.section->angle_of(core::Vec3::Zero());
    PlaneShift shift;
    shift.displacement = to.section->point(angle);
    const double new_segment_a = (target.a - shift.displacement).norm();
    const double new_segment_b = (target.b - shift.displacement).norm();
    if (!to.is_resolved(new_segment_a, new_segment_b, rounding_m)) {
        return trace.reject(ShiftRejection::Degenerate);
    }
    const double residual = new_segment_a + new_segment_b - to.length;
    if (!(std::abs(residual) <= kShiftTolerance * std::min(1.0, to.length))) {
        return trace.reject(ShiftRejection::NotConverged);
    }
    shift.jacobian = change.ratio * to.section->area_per_opl_and_angle(shift.displacement, angle) /
                     from.section->area_per_opl_and_angle(core::Vec3::Zero(), angle);
    if (!(shift.jacobian > 0.0) || !std::isfinite(shift.jacobian)) {
        return trace.reject(ShiftRejection::Degenerate);
    }
    return shift;
}

}  // namespace renderer
