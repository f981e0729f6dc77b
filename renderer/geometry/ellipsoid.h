// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"

#include <optional>

namespace renderer {

/// The two fixed neighbours of a path vertex [m, world]. They may coincide (confocal pairs).
struct FocusPair {
    core::Vec3 a;
    core::Vec3 b;

    /// Length of the segments a -> x -> b [m].
    double opl_m(const core::Vec3& x) const { return (x - a).norm() + (x - b).norm(); }
};

/// Shortest and longest length of the segments over some surface [m].
struct OplBand {
    double low_m = 0.0;
    double high_m = 0.0;

    double width_m() const { return high_m - low_m; }
};

/// Bounds of the length over a facet: the longest is exact, the shortest a lower bound.
OplBand opl_band(const FocusPair& foci, const Facet& facet);

/// A closed curve: the points of a plane whose segments have one length, by an angle theta.
///
/// The map that turns the ellipsoid into the unit sphere turns the curve into a circle; theta runs
/// along it from the image of the facet's first edge. That start is the same world direction for
/// all foci and lengths, so (length, theta) are coordinates of the plane for each pair of foci, and
/// keeping theta carries a point from one pair to another.
class EllipsoidSection {
 public:
    /// foci     fixed neighbours, in any position, also equal
    /// opl_m    length of the segments [m]
    /// plane    facet whose plane, not only its triangle, is cut
    /// returns  nothing when the ellipsoid misses the plane or touches it in little more than a
    ///          point, or when the length does not exceed the distance of the foci
    static std::optional<EllipsoidSection> cut(const FocusPair& foci,
                                               double opl_m,
                                               const Facet& plane);

    /// Of the circle on the unit sphere; 0 where the ellipsoid touches the plane.
    double circle_radius() const { return radius_; }
    /// Point at an angle given as (cos theta, sin theta).
    core::Vec3 point(const core::Vec2& angle) const;
    /// (cos theta, sin theta) of a point of the curve.
    core::Vec2 angle_of(const core::Vec3& x) const;

    /// dx/dtheta at an angle [m/rad].
    core::Vec3 tangent(const core::Vec2& angle) const;

    /// dA/(dtau dtheta) at a point of the curve: area of the plane per length and angle [m/rad].
    ///
    /// The curve of the next length lies dtau / |grad_T l| away, grad_T l being the part of the
    /// length's gradient in the plane; along the curve theta advances by dtheta in |dx/dtheta|.
    /// Confocal, the curve is a circle and the value opl/4.
    double area_per_opl_and_angle(const core::Vec3& x, const core::Vec2& angle) const;

 private:
    friend class EllipsoidArcs;

    core::Vec3 to_sphere(const core::Vec3& v) const {
        return v / minor_m_ - axis_ * (axis_.dot(v) * squeeze_);
    }
    core::Vec3 to_world(const core::Vec3& v) const {
        return v * minor_m_ + axis_ * (axis_.dot(v) * stretch_);
    }

    FocusPair foci_;
    core::Vec3 center_;  ///< midpoint of the foci
    core::Vec3 axis_;    ///< from focus a to focus b, not normalised
    core::Vec3 normal_;  ///< of the plane
    double minor_m_ = 0.0;
    double stretch_ = 0.0;  ///< sphere to world: v -> minor v + stretch axis (axis . v)
    double squeeze_ = 0.0;  ///< world to sphere: v -> v / minor - squeeze axis (axis . v)
    core::Vec3 circle_center_;
    core::Vec3 e1_;  ///< of the circle's plane, theta = 0
    core::Vec3 e2_;
    double radius_ = 0.0;
};

/// The parts of a section that lie within the facet's triangle: at most three arcs.
class EllipsoidArcs {
 public:
    EllipsoidArcs(const EllipsoidSection& section, const Facet& facet);

    double total_rad() const { return total_rad_; }
    /// (cos theta, sin theta) at the fraction u of [0, 1) of all arcs; total_rad() must not be 0.
    core::Vec2 sample(double u) const;
    /// The u that sample() maps to an angle; clamped to the nearer end between arcs.
    double invert(const core::Vec2& angle) const;

 private:
    struct Arc {
        core::Vec2 begin;
        double length_rad = 0.0;
    };
    std::array<Arc, 3> arcs_;
    std::size_t num_arcs_ = 0;
    double total_rad_ = 0.0;
};

/// A vertex whose two segments have the requested length.
struct EllipsoidalConnection {
    core::Vec3 position;
    /// Its density by area for a density of the length of 1 [1/m]: times pdf_opl it is pdf_area.
    double pdf_area_per_pdf_opl = 0.0;
};

/// A narrow lobe at focus a, towards which vertices are placed more often.
struct ConnectionLobe {
    core::Vec3 direction;    ///< unit, from focus a along the middle of the lobe
    core::Vec3 point;        ///< where that meets the facet's plane
    double width_rad = 0.0;  ///< angle at which the lobe has fallen to about a half
};

/// Samples a vertex on a facet whose two segments have exactly the requested length.
///
/// foci      fixed neighbours of the vertex
/// opl_m     required |a - x| + |x - b| [m]
/// facet     triangle to stay in
/// u         uniform random number in [0, 1)
/// lobe      null: uniformly along the curve's angle. Else by a Cauchy distribution about the angle
///           nearest to the lobe, as wide as the lobe and its distance from the curve
/// returns   vertex and density; nothing if the ellipsoid misses the triangle
/// source    [Pediredla2019]; measure derived in REFERENCES.md
std::optional<EllipsoidalConnection> sample_ellipsoid(const FocusPair& foci,
                                                      double opl_m,
                                                      const Facet& facet,
                                                      double u,
                                                      const ConnectionLobe* lobe = nullptr);

/// Density of sample_ellipsoid() at a point `x` of the facet, given its own length [1/m]; 0 where
/// no sample can fall.
double pdf_ellipsoid(const FocusPair& foci,
                     const Facet& facet,
                     const core::Vec3& x,
                     const ConnectionLobe* lobe = nullptr);

}  // namespace renderer
