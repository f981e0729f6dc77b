// SPDX-License-Identifier: MIT
#include "renderer/geometry/ellipsoid.h"

#include "renderer/core/sampling.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::kPi;
using core::Vec2;
using core::Vec3;

// Circles smaller than this on the unit sphere are points: they carry no more than rounding.
constexpr double kSmallestRadius = 1e-7;

Vec2 left_of(const Vec2& v) {
    return {-v.y(), v.x()};
}

// Angle from `from` anticlockwise to `to`, in [0, 2 pi).
double angle_between(const Vec2& from, const Vec2& to) {
    const double angle = std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
    return angle < 0.0 ? angle + 2.0 * kPi : angle;
}

// Where a triangle's boundary crosses a circle, as unit vectors from the circle's centre.
struct Crossings {
    std::array<Vec2, 3> entering;  ///< walking anticlockwise on the circle, into the triangle
    std::array<Vec2, 3> leaving;
    std::size_t num_entering = 0;
    std::size_t num_leaving = 0;
};

// Crossings of one edge, from `start` over `along`. The circle has radius^2 `radius2`; c = |p|^2 -
// radius^2 at the edge's ends says which ends lie inside, so that edges which share a corner agree.
// The triangle runs anticlockwise: an edge that leaves the circle is where the circle enters it.
void add_crossings(const Vec2& start,
                   const Vec2& along,
                   double start_c,
                   double end_c,
                   double radius,
                   Crossings& crossings) {
    const bool starts_inside = start_c < 0.0;
    const bool ends_inside = end_c < 0.0;
    if (starts_inside && ends_inside) return;
    const double a = along.squaredNorm();
    const double b = start.dot(along);
    const double discriminant = b * b - a * start_c;
    const auto at = [&](double s) { return Vec2((start + s * along) / radius); };
    if (starts_inside != ends_inside) {
        const double root = std::sqrt(std::max(0.0, discriminant));
        // The two ways to write a root of a quadratic; each is free of cancellation for one sign.
        if (starts_inside) {
            const double s = b > 0.0 ? -start_c / (b + root) : (root - b) / a;
            crossings.entering[crossings.num_entering++] = at(s);
        } else {
            const double s = b < 0.0 ? start_c / (root - b) : (-b - root) / a;
            crossings.leaving[crossings.num_leaving++] = at(s);
        }
        return;
    }
    // Both ends outside: through the circle when the nearest point lies between them and inside.
    if (!(b < 0.0) || !(-b < a) || !(discriminant > 0.0)) return;
    const double root = std::sqrt(discriminant);
    crossings.leaving[crossings.num_leaving++] = at(start_c / (root - b));
    crossings.entering[crossings.num_entering++] = at((root - b) / a);
}

// Density over the fractions of all arcs: uniform, or a Cauchy distribution cut off at 0 and 1.
class ArcDensity {
 public:
    ArcDensity(const FocusPair& foci,
               const EllipsoidSection& section,
               const EllipsoidArcs& arcs,
               const ConnectionLobe* lobe) {
        if (lobe == nullptr) return;
        const Vec2 nearest = section.angle_of(lobe->point);
        const Vec3 segment = section.point(nearest) - foci.a;
        const double distance = segment.norm();
        const Vec3 direction = segment / distance;
        const Vec3 tangent = section.tangent(nearest);
        const double turn_per_fraction =  // as seen from the focus [rad]
            arcs.total_rad() * (tangent - direction * direction.dot(tangent)).norm() / distance;
        const double width_rad = std::hypot(lobe->width_rad, (direction - lobe->direction).norm());
        scale_ = std::max(width_rad / turn_per_fraction, kNarrowest);  // stays what is not a number
        if (!(scale_ < kWidest)) return;
        is_uniform_ = false;
        middle_ = arcs.invert(nearest);
        begin_ = std::atan(-middle_ / scale_);
        span_ = std::atan((1.0 - middle_) / scale_) - begin_;
    }

    double sample(double u) const {
        if (is_uniform_) return u;
        return std::clamp(middle_ + scale_ * std::tan(begin_ + u * span_), 0.0, core::kBelowOne);
    }
    double pdf(double fraction) const {
        if (is_uniform_) return 1.0;
        const double off = (fraction - middle_) / scale_;
        return 1.0 / (scale_ * span_ * (1.0 + off * off));
    }

 private:
    static constexpr double kNarrowest = 1e-4;
    static constexpr double kWidest = 1.0;  // a lobe as wide as all arcs decides nothing

    bool is_uniform_ = true;
    double middle_ = 0.0;
    double scale_ = 1.0;
    double begin_ = 0.0;  ///< of the angle whose tangent is the distance from the middle
    double span_ = 0.0;
};

}  // namespace

OplBand opl_band(const FocusPair& foci, const Facet& facet) {
    const std::array<Vec3, 3> corners = facet.corners();
    OplBand band;
    for (const Vec3& corner : corners) band.high_m = std::max(band.high_m, foci.opl_m(corner));

    // The length is convex, so it stays above its tangent at the centroid ...
    const Vec3 centroid = facet.corner + (facet.edge1 + facet.edge2) / 3.0;
    const Vec3 from_a = centroid - foci.a;
    const Vec3 from_b = centroid - foci.b;
    const double distance_a = from_a.norm();
    const double distance_b = from_b.norm();
    const Vec3 gradient = from_a / distance_a + from_b / distance_b;
    double slope = 0.0;
    for (const Vec3& corner : corners) slope = std::min(slope, gradient.dot(corner - centroid));
    // ... and above its minimum over the plane, where light would be mirrored.
    const double height = std::abs(facet.normal.dot(from_a)) + std::abs(facet.normal.dot(from_b));
    const Vec3 apart = foci.b - foci.a;
    const double across2 =
        std::max(0.0, apart.squaredNorm() - std::pow(facet.normal.dot(apart), 2));
    band.low_m = std::max(distance_a + distance_b + slope, std::sqrt(height * height + across2));
    // A centroid at a focus has no gradient.
    if (!std::isfinite(band.low_m)) band.low_m = std::sqrt(height * height + across2);
    band.low_m = std::min(band.low_m, band.high_m);
    return band;
}

std::optional<EllipsoidSection> EllipsoidSection::cut(const FocusPair& foci,
                                                      double opl_m,
                                                      const Facet& plane) {
    EllipsoidSection s;
    s.axis_ = foci.b - foci.a;
    const double distance2 = s.axis_.squaredNorm();
    const double distance = std::sqrt(distance2);
    if (!(opl_m > distance)) return std::nullopt;
    s.foci_ = foci;
    s.center_ = 0.5 * (foci.a + foci.b);
    s.normal_ = plane.normal;

    // Semi-axes A = tau/2 along the foci and b = sqrt(A^2 - c^2), 2c their distance. Stretching by
    // A along the unit axis w and by b across it is b I + (A - b) w w^T, and A - b = c^2/(A + b):
    // with w = axis/2c the distance cancels, so nothing happens when the foci meet.
    const double major = 0.5 * opl_m;
    s.minor_m_ = 0.5 * std::sqrt((opl_m - distance) * (opl_m + distance));
    if (!(s.minor_m_ > kSmallestRadius * major)) return std::nullopt;
    s.stretch_ = 0.25 / (major + s.minor_m_);
    s.squeeze_ = s.stretch_ / (major * s.minor_m_);

    const Vec3 image = s.to_world(plane.normal);  // the stretch is symmetric
    const double length = image.norm();
    const Vec3 m = image / length;
    const double h = plane.normal.dot(plane.corner - s.center_) / length;
    const double radius2 = (1.0 - h) * (1.0 + h);
    if (!(radius2 > kSmallestRadius * kSmallestRadius)) return std::nullopt;
    s.radius_ = std::sqrt(radius2);
    s.circle_center_ = h * m;
    const Vec3 edge = s.to_sphere(plane.edge1);
    s.e1_ = (edge - m * m.dot(edge)).normalized();
    s.e2_ = m.cross(s.e1_);
    return s;
}

Vec3 EllipsoidSection::point(const Vec2& angle) const {
    return center_ +
           to_world(circle_center_ + e1_ * (radius_ * angle.x()) + e2_ * (radius_ * angle.y()));
}

Vec2 EllipsoidSection::angle_of(const Vec3& x) const {
    const Vec3 q = to_sphere(x - center_);
    return Vec2(q.dot(e1_), q.dot(e2_)).normalized();
}

Vec3 EllipsoidSection::tangent(const Vec2& angle) const {
    return radius_ * to_world(e2_ * angle.x() - e1_ * angle.y());
}

double EllipsoidSection::area_per_opl_and_angle(const Vec3& x, const Vec2& angle) const {
    const Vec3 gradient = (x - foci_.a).normalized() + (x - foci_.b).normalized();
    const Vec3 in_plane = gradient - normal_ * normal_.dot(gradient);
    return std::sqrt(tangent(angle).squaredNorm() / in_plane.squaredNorm());
}

EllipsoidArcs::EllipsoidArcs(const EllipsoidSection& section, const Facet& facet) {
    const auto flatten = [&](const Vec3& v) {
        const Vec3 q = section.to_sphere(v);
        return Vec2(q.dot(section.e1_), q.dot(section.e2_));
    };
    // e1 is the image of the first edge, and the map keeps the triangle's sense of rotation.
    const Vec2 p0 = flatten(facet.corner - section.center_);
    const Vec2 edge1 = flatten(facet.edge1);
    const Vec2 edge2 = flatten(facet.edge2);
    const double radius2 = section.radius_ * section.radius_;
    const double c0 = p0.squaredNorm() - radius2;
    const double c1 = (p0 + edge1).squaredNorm() - radius2;
    const double c2 = (p0 + edge2).squaredNorm() - radius2;
    Crossings crossings;
    add_crossings(p0, edge1, c0, c1, section.radius_, crossings);
    add_crossings(p0 + edge1, edge2 - edge1, c1, c2, section.radius_, crossings);
    add_crossings(p0 + edge2, -edge2, c2, c0, section.radius_, crossings);

    if (crossings.num_entering == 0) {
        // All or nothing: the circle's centre is inside and so is the triangle outside the circle.
        const bool around = left_of(edge1).dot(-p0) > 0.0 &&
                            left_of(edge2 - edge1).dot(-(p0 + edge1)) > 0.0 &&
                            left_of(-edge2).dot(-(p0 + edge2)) > 0.0;
        if (!around || c0 < 0.0) return;
        arcs_[0] = {Vec2::UnitX(), 2.0 * kPi};
        num_arcs_ = 1;
        total_rad_ = 2.0 * kPi;
        return;
    }
    for (std::size_t i = 0; i < crossings.num_entering; ++i) {
        // An arc ends where the circle leaves the triangle next.
        double length = 2.0 * kPi;
        for (std::size_t j = 0; j < crossings.num_leaving; ++j) {
            length = std::min(length, angle_between(crossings.entering[i], crossings.leaving[j]));
        }
        arcs_[num_arcs_++] = {crossings.entering[i], length};
        total_rad_ += length;
    }
}

Vec2 EllipsoidArcs::sample(double u) const {
    double rest = u * total_rad_;
    std::size_t i = 0;
    while (i + 1 < num_arcs_ && rest >= arcs_[i].length_rad) rest -= arcs_[i++].length_rad;
    rest = std::min(rest, arcs_[i].length_rad);
    const Vec2& begin = arcs_[i].begin;
    return (std::cos(rest) * begin + std::sin(rest) * left_of(begin)).normalized();
}

double EllipsoidArcs::invert(const Vec2& angle) const {
    double before = 0.0;
    double nearest_gap = 2.0 * kPi;
    double result = 0.0;
    for (std::size_t i = 0; i < num_arcs_; ++i) {
        const double offset = angle_between(arcs_[i].begin, angle);
        const double past_end = std::max(0.0, offset - arcs_[i].length_rad);
        const double before_begin = past_end > 0.0 ? 2.0 * kPi - offset : 0.0;
        const double gap = std::min(past_end, before_begin);
        if (gap < nearest_gap) {
            nearest_gap = gap;
            result = before + (past_end > before_begin ? 0.0 : offset - past_end);
        }
        before += arcs_[i].length_rad;
    }
    return std::min(result / total_rad_, core::kBelowOne);
}

std::optional<EllipsoidalConnection> sample_ellipsoid(
    const FocusPair& foci, double opl_m, const Facet& facet, double u, const ConnectionLobe* lobe) {
    const auto section = EllipsoidSection::cut(foci, opl_m, facet);
    if (!section) return std::nullopt;
    const EllipsoidArcs arcs(*section, facet);
    if (!(arcs.total_rad() > 0.0)) return std::nullopt;
    const ArcDensity density(foci, *section, arcs, lobe);
    const double fraction = density.sample(u);
    const Vec2 angle = arcs.sample(fraction);
    EllipsoidalConnection connection;
    connection.position = section->point(angle);
    connection.pdf_area_per_pdf_opl =
        density.pdf(fraction) /
        (arcs.total_rad() * section->area_per_opl_and_angle(connection.position, angle));
    if (!(connection.pdf_area_per_pdf_opl > 0.0)) return std::nullopt;
    return connection;
}

double pdf_ellipsoid(const FocusPair& foci,
                     const Facet& facet,
                     const Vec3& x,
                     const ConnectionLobe* lobe) {
    const auto section = EllipsoidSection::cut(foci, foci.opl_m(x), facet);
    if (!section) return 0.0;
    const EllipsoidArcs arcs(*section, facet);
    if (!(arcs.total_rad() > 0.0)) return 0.0;
    const Vec2 angle = section->angle_of(x);
    const double pdf = 1.0 / (arcs.total_rad() * section->area_per_opl_and_angle(x, angle));
    if (!std::isfinite(pdf)) return 0.0;
    if (lobe == nullptr) return pdf;
    return pdf * ArcDensity(foci, *section, arcs, lobe).pdf(arcs.invert(angle));
}

}  // namespace renderer
