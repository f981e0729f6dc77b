// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/geometry/ellipsoid.h"
#include "tests/hard_cases/extended_precision.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace truth {

/// The curve of one path length in a plane, by the map onto the unit sphere of the design: explicit
/// unit axes and semi-axes, fit for extended precision only.
class Section {
 public:
    /// foci     fixed neighbours
    /// facet    corner and edges count; its normal is computed again
    static std::optional<Section> cut(const renderer::FocusPair& foci,
                                      Quad opl,
                                      const renderer::Facet& facet) {
        Section s;
        s.a_ = foci.a;
        s.b_ = foci.b;
        const QuadVec apart = s.b_ - s.a_;
        const Quad distance = apart.norm();
        if (!(opl > distance)) return std::nullopt;
        s.centre_ = 0.5 * (s.a_ + s.b_);
        s.normal_ = QuadVec(facet.edge1).cross(facet.edge2).normalized();
        const QuadVec w0 = distance > 0 ? (1 / distance) * apart : QuadVec(1, 0, 0);
        const QuadVec other = w0.x * w0.x < 0.5 ? QuadVec(1, 0, 0) : QuadVec(0, 1, 0);
        const QuadVec w1 = w0.cross(other).normalized();
        s.axes_ = {w0, w1, w0.cross(w1)};
        const Quad minor = sqrtq((opl - distance) * (opl + distance)) / 2;
        s.semi_ = {opl / 2, minor, minor};
        // The plane n.(x - corner) = 0 becomes m.q = h.
        QuadVec m = s.scaled(s.turned(s.normal_), false);
        const Quad length = m.norm();
        m = (1 / length) * m;
        const Quad h = s.normal_.dot(QuadVec(facet.corner) - s.centre_) / length;
        if (!(h * h < 1)) return std::nullopt;
        s.radius_ = sqrtq(1 - h * h);
        s.circle_centre_ = h * m;
        const QuadVec edge = s.to_sphere(facet.edge1);
        s.e1_ = (edge - m.dot(edge) * m).normalized();
        s.e2_ = m.cross(s.e1_);
        return s;
    }

    Quad radius() const { return radius_; }

    QuadVec point(Quad cosine, Quad sine) const {
        const QuadVec q = circle_centre_ + (radius_ * cosine) * e1_ + (radius_ * sine) * e2_;
        return centre_ + turned_back(scaled(q, false));
    }
    Quad theta_of(const QuadVec& x) const {
        const QuadVec q = to_sphere(x - centre_);
        return atan2q(q.dot(e2_), q.dot(e1_));
    }

    /// rc |Q^T E t| / |grad_T l|.
    Quad area_per_opl_and_angle(const QuadVec& x) const {
        const Quad theta = theta_of(x);
        const QuadVec t = cosq(theta) * e2_ - sinq(theta) * e1_;
        const QuadVec gradient = (x - a_).normalized() + (x - b_).normalized();
        const QuadVec tangential = gradient - normal_.dot(gradient) * normal_;
        return radius_ * scaled(t, false).norm() / tangential.norm();
    }

    /// Angle of the circle within the triangle: cut by every edge, arcs kept whose middle is
    /// inside.
    Quad angle_within(const renderer::Facet& facet) const {
        std::array<std::array<Quad, 2>, 3> p;
        const std::array<QuadVec, 3> corners{
            facet.corner, QuadVec(facet.corner) + facet.edge1, QuadVec(facet.corner) + facet.edge2};
        for (std::size_t i = 0; i < 3; ++i) {
            const QuadVec q = to_sphere(corners[i] - centre_);
            p[i] = {q.dot(e1_), q.dot(e2_)};
        }
        std::vector<Quad> cuts;
        for (std::size_t i = 0; i < 3; ++i) add_cuts(p[i], p[(i + 1) % 3], cuts);
        std::sort(cuts.begin(), cuts.end());
        if (cuts.empty()) cuts.push_back(-pi());
        cuts.push_back(cuts.front() + 2 * pi());
        Quad kept = 0;
        for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
            const Quad middle = (cuts[i] + cuts[i + 1]) / 2;
            if (is_inside(p, {radius_ * cosq(middle), radius_ * sinq(middle)})) {
                kept += cuts[i + 1] - cuts[i];
            }
        }
        return kept;
    }

 private:
    using Point2 = std::array<Quad, 2>;

    QuadVec turned(const QuadVec& v) const {
        return {axes_[0].dot(v), axes_[1].dot(v), axes_[2].dot(v)};
    }
    QuadVec turned_back(const QuadVec& v) const {
        return v.x * axes_[0] + v.y * axes_[1] + v.z * axes_[2];
    }
    QuadVec scaled(const QuadVec& v, bool inverse) const {
        if (inverse) return {v.x / semi_[0], v.y / semi_[1], v.z / semi_[2]};
        return {v.x * semi_[0], v.y * semi_[1], v.z * semi_[2]};
    }
    QuadVec to_sphere(const QuadVec& v) const { return scaled(turned(v), true); }

    void add_cuts(const Point2& from, const Point2& to, std::vector<Quad>& cuts) const {
        const Quad dx = to[0] - from[0];
        const Quad dy = to[1] - from[1];
        const Quad a = dx * dx + dy * dy;
        const Quad b = from[0] * dx + from[1] * dy;
        const Quad c = from[0] * from[0] + from[1] * from[1] - radius_ * radius_;
        const Quad discriminant = b * b - a * c;
        if (!(discriminant > 0)) return;
        for (const Quad root : {-sqrtq(discriminant), sqrtq(discriminant)}) {
            const Quad s = (root - b) / a;
            if (s < 0 || s > 1) continue;
            cuts.push_back(atan2q(from[1] + s * dy, from[0] + s * dx));
        }
    }
    static bool is_inside(const std::array<Point2, 3>& p, const Point2& x) {
        int left = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Point2& from = p[i];
            const Point2& to = p[(i + 1) % 3];
            const Quad cross =
                (to[0] - from[0]) * (x[1] - from[1]) - (to[1] - from[1]) * (x[0] - from[0]);
            left += cross > 0 ? 1 : 0;
        }
        return left == 0 || left == 3;
    }

    QuadVec a_, b_, centre_, normal_, circle_centre_, e1_, e2_;
    std::array<QuadVec, 3> axes_;
    std::array<Quad, 3> semi_;
    Quad radius_ = 0;
};

/// Length of the segments to x.
inline Quad opl_of(const renderer::FocusPair& foci, const QuadVec& x) {
    return (x - foci.a).norm() + (x - foci.b).norm();
}

/// Density by area, for a density of the length of 1, of a vertex drawn at the length of x.
inline Quad pdf_area_per_pdf_opl(const renderer::FocusPair& foci,
                                 const renderer::Facet& facet,
                                 const QuadVec& x) {
    const auto section = Section::cut(foci, opl_of(foci, x), facet);
    if (!section) return 0;
    const Quad angle = section->angle_within(facet);
    return angle > 0 ? 1 / (angle * section->area_per_opl_and_angle(x)) : 0;
}

}  // namespace truth
