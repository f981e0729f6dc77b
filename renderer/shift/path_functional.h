// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

namespace renderer {

/// A functional is a quantity of a path that changes by a given amount while its reconnection
/// vertex p moves between the neighbours a and y (the foci). Its `expand(p, velocity of the surface
/// at p)` gives an expansion with `value`, `gradient`, `hessian_times(t)` and `gradient_size`, a
/// scale that the norm of the gradient cannot exceed by much.
///
/// Points are relative to an origin near p, so that no precision is lost far from the world's
/// origin.
///
/// To add one: a struct with `expand`; instantiate the routes of shift_mapping.cpp with it.
/// With r = focus - p, d = |r|, u = r/d:  du/dp = -(I - u u^T)/d, and everything below follows.

/// The two segments from p to the foci.
struct FocusSegments {
    double length_a;
    double length_y;
    double inverse_a;  ///< 1/d_a
    double inverse_y;
    core::Vec3 to_a;  ///< u_a, unit
    core::Vec3 to_y;

    FocusSegments(const core::Vec3& r_a, const core::Vec3& r_y)
        : length_a(r_a.norm()),
          length_y(r_y.norm()),
          inverse_a(1.0 / length_a),
          inverse_y(1.0 / length_y),
          to_a(inverse_a * r_a),
          to_y(inverse_y * r_y) {}
};

/// Optical path length |a - p| + |y - p| [m] (source [Kim2026], equation 3).
struct OpticalLength {
    core::Vec3 focus_a;
    core::Vec3 focus_y;

    struct Expansion : FocusSegments {
        using FocusSegments::FocusSegments;
        double value = length_a + length_y;
        core::Vec3 gradient = -(to_a + to_y);
        double gradient_size = 1.0;

        /// H t = sum (t - u (u.t))/d.
        core::Vec3 hessian_times(const core::Vec3& t) const {
            return (inverse_a + inverse_y) * t - (inverse_a * to_a.dot(t)) * to_a -
                   (inverse_y * to_y.dot(t)) * to_y;
        }
    };

    Expansion expand(const core::Vec3& p, const core::Vec3& /*surface_velocity*/) const {
        return {focus_a - p, focus_y - p};
    }
};

/// Path velocity d/dt (|a - p| + |y - p|) = u_a.w_a + u_y.w_y [m/s], w = velocity of the focus
/// minus that of the surface at p.
///
/// The supplement's equations (10) and (11) are misprinted: (10) puts the velocity, which is not a
/// unit vector, where the direction belongs and loses the factor w; (11) has -2c u u^T - c I where
/// the derivative gives c I - 3c u u^T. Correct, from the derivative of u above, c = u.w:
///     gradient = -sum (w - c u)/d
///     Hessian  = -sum (u w^T + w u^T + c I - 3 c u u^T)/d^2
/// (source [Kim2026], section 2, corrected).
struct PathVelocity {
    core::Vec3 focus_a;
    core::Vec3 focus_y;
    core::Vec3 velocity_a;
    core::Vec3 velocity_y;

    struct Expansion : FocusSegments {
        using FocusSegments::FocusSegments;
        double value = 0.0;
        core::Vec3 gradient;
        core::Vec3 relative_a;  ///< w_a
        core::Vec3 relative_y;
        double gradient_size = 0.0;

        core::Vec3 hessian_times(const core::Vec3& t) const {
            return segment(to_a, relative_a, inverse_a, t) +
                   segment(to_y, relative_y, inverse_y, t);
        }

     private:
        static core::Vec3 segment(const core::Vec3& u,
                                  const core::Vec3& w,
                                  double inverse,
                                  const core::Vec3& t) {
            const double c = u.dot(w);
            const double u_t = u.dot(t);
            return (-inverse * inverse) * ((w.dot(t) - 3.0 * c * u_t) * u + u_t * w + c * t);
        }
    };

    Expansion expand(const core::Vec3& p, const core::Vec3& surface_velocity) const {
        Expansion e(focus_a - p, focus_y - p);
        e.relative_a = velocity_a - surface_velocity;
        e.relative_y = velocity_y - surface_velocity;
        const double c_a = e.to_a.dot(e.relative_a);
        const double c_y = e.to_y.dot(e.relative_y);
        e.value = c_a + c_y;
        e.gradient = -e.inverse_a * (e.relative_a - c_a * e.to_a) -
                     e.inverse_y * (e.relative_y - c_y * e.to_y);
        e.gradient_size = e.inverse_a * e.relative_a.norm() + e.inverse_y * e.relative_y.norm();
        return e;
    }
};

}  // namespace renderer
