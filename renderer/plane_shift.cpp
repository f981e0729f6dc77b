// SPDX-License-Identifier: MIT
#include "renderer/plane_shift.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec2;
using core::Vec3;

// Ellipsoid |x-a| + |x-y| = tau: centre C = (a+y)/2, semi-axes tau/2 along f = y-a and
// b = sqrt(tau^2 - |f|^2)/2 across. It is the image of the unit sphere, |M (x-C)| = 1 with
//     M^2 = (I - f f^T/tau^2)/b^2,
// which never divides by |f|: coincident foci are nothing special.
//
// On the plane let p = (p1, p2) be coordinates relative to C, f = (f1, f2, fn), delta the normal
// coordinate of the plane relative to C, and za, zy the normal coordinates of the foci relative to
// the plane. Completing the square in |M (x-C)|^2 = 1,
//     rho^T G rho = r^2,   rho = p - p_c,   p_c = delta fn (f1, f2)/Q,   Q = tau^2 - f1^2 - f2^2,
//     G = I - (f1, f2)(f1, f2)^T/tau^2,   r^2 = 4 b^2 (b^2 - za zy)/Q:
// the section is an ellipse around p_c. With G = L L^T, w = L^T rho lies on a circle of radius r;
// its first axis is the image of tangent1. The relative radius r_c of the section, in units where
// the ellipsoid is the unit sphere, is r_c^2 = 4 (b^2 - za zy)/Q.
//
// Area: between tau and tau + dtau the ellipses are dtau/|grad l| apart, so
// dA = |dx/dtheta|/|grad l| dtau dtheta with the gradient within the plane.
constexpr double kSmallestCircle = 1e-7;  ///< of r_c: closer to the tangent point is rounding

struct Section {
    Vec2 centre;  ///< p_c + C, in-plane coordinates relative to the moving point
    double radius = 0.0;
    double l11 = 0.0;
    double l21 = 0.0;
    double l22 = 0.0;

    Vec2 rho_of(const Vec2& w) const {
        const double rho2 = w.y() / l22;
        return {(w.x() - l21 * rho2) / l11, rho2};
    }
    Vec2 w_of(const Vec2& rho) const { return {l11 * rho.x() + l21 * rho.y(), l22 * rho.y()}; }
};

// The foci in the frame of the plane: in-plane and normal coordinates relative to the point.
struct PlaneFoci {
    Vec2 a, y;
    double za, zy;

    PlaneFoci(const PlaneFrame& plane, const Foci& foci)
        : a(plane.tangent1.dot(foci.a), plane.tangent2.dot(foci.a)),
          y(plane.tangent1.dot(foci.y), plane.tangent2.dot(foci.y)),
          za(plane.normal.dot(foci.a)),
          zy(plane.normal.dot(foci.y)) {}
};

// four_b2   4 b^2, given apart because its best formula differs between the ends
std::optional<Section> section_of(const PlaneFoci& foci, double tau, double four_b2) {
    const Vec2 f = foci.y - foci.a;
    const double inverse_tau2 = 1.0 / (tau * tau);
    const double q = tau * tau - f.squaredNorm();
    const double g4 = four_b2 - 4.0 * foci.za * foci.zy;
    if (!(four_b2 > 0.0) || !(g4 > kSmallestCircle * kSmallestCircle * q)) return std::nullopt;
    Section section;
    const double delta = -0.5 * (foci.za + foci.zy);
    const double fn = foci.zy - foci.za;
    section.centre = 0.5 * (foci.a + foci.y) + (delta * fn / q) * f;
    section.radius = std::sqrt(0.25 * four_b2 * g4 / q);
    const double l11_squared = 1.0 - f.x() * f.x() * inverse_tau2;
    section.l11 = std::sqrt(l11_squared);
    section.l21 = -f.x() * f.y() * inverse_tau2 / section.l11;
    section.l22 = std::sqrt(q * inverse_tau2 / l11_squared);
    return section;
}

// |dx/dtheta| at the point of angle (cosine, sine) = c.
double speed_around(const Section& section, const Vec2& c) {
    return section.radius * section.rho_of({-c.y(), c.x()}).norm();
}

}  // namespace

std::optional<PlaneShift> shift_on_plane(const PlaneFrame& plane,
                                         const Foci& source,
                                         const Foci& target,
                                         const LengthChange& change,
                                         ShiftTrace& trace) {
    const PlaneFoci s(plane, source);
    const double d_a = source.a.norm();
    const double d_y = source.y.norm();
    const double tau = d_a + d_y;
    // tau^2 - |f|^2 = 2 (d_a d_y + r_a.r_y).
    const auto from = section_of(s, tau, 2.0 * (d_a * d_y + source.a.dot(source.y)));
    if (!from) return trace.reject(ShiftRejection::Degenerate);
    const Vec2 c = from->w_of(-from->centre) / from->radius;
    const double inverse_norm = 1.0 / c.norm();
    const Vec2 unit = inverse_norm * c;

    const PlaneFoci t(plane, target);
    const double new_tau = change.ratio * tau + change.offset_m;
    const double focal = (target.y - target.a).norm();
    if (!(new_tau > focal)) return trace.reject(ShiftRejection::BelowMinimum);
    const auto to = section_of(t, new_tau, (new_tau - focal) * (new_tau + focal));
    if (!to) return trace.reject(ShiftRejection::BelowMinimum);
    const Vec2 moved = to->centre + to->rho_of(to->radius * unit);

    PlaneShift shift;
    shift.displacement = moved.x() * plane.tangent1 + moved.y() * plane.tangent2;
    const double new_a = std::sqrt((t.a - moved).squaredNorm() + t.za * t.za);
    const double new_y = std::sqrt((t.y - moved).squaredNorm() + t.zy * t.zy);
    // Rounding grows near the segment between the foci; what misses its length is not taken.
    const double allowed = 1e-9 * std::min(1.0, new_tau);
    if (!(std::abs(new_a + new_y - new_tau) <= allowed) || !(std::abs(inverse_norm - 1.0) < 1e-6)) {
        return trace.reject(ShiftRejection::NotConverged);
    }
    const double slope = (s.a / d_a + s.y / d_y).norm();
    const double new_slope = ((t.a - moved) / new_a + (t.y - moved) / new_y).norm();
    shift.jacobian =
        change.ratio * (speed_around(*to, unit) * slope) / (speed_around(*from, unit) * new_slope);
    if (!(shift.jacobian > 0.0) || !std::isfinite(shift.jacobian)) {
        return trace.reject(ShiftRejection::Degenerate);
    }
    return shift;
}

}  // namespace renderer
