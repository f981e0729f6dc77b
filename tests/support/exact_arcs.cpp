// SPDX-License-Identifier: MIT
#include "tests/support/exact_arcs.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace test_support {
namespace {

using core::kPi;
using core::Mat3;
using core::TimeAxis;
using core::Vec2;
using core::Vec3;

// In the plane of the triangle let (q, phi) be polar coordinates about the foot f of the wall point
// w, and D = |f - w|. Points of range r = sqrt(D^2 + q^2) form a circle, and dA = q dq dphi =
// r dr dphi. With d = f - w + q (cos phi e1 + sin phi e2) the cosine at the wall is n_w.d/r =
// (a + q (b cos phi + c sin phi))/r, the one at the facet D/r. The density in r is therefore
//
//     h(r) = D^2 r^-7  Int_arcs (a + b q cos phi + c q sin phi)^2 dphi,
//
// whose antiderivative in phi is elementary.
struct Plane {
    double distance = 0.0;             // D
    double a = 0.0, b = 0.0, c = 0.0;  // n_w.(f-w), n_w.e1, n_w.e2
    std::array<Vec2, 3> corners;       // relative to f, counter-clockwise
};

Plane make_plane(const std::array<Vec3, 3>& corners, const Vec3& point, const Vec3& wall_normal) {
    const Vec3 edge = corners[1] - corners[0];
    const Vec3 normal = edge.cross(corners[2] - corners[0]).normalized();
    const Mat3 frame = core::frame_from_normal(normal, edge);
    const double height = normal.dot(corners[0] - point);
    Plane plane;
    plane.distance = std::abs(height);
    plane.a = height * wall_normal.dot(normal);
    plane.b = wall_normal.dot(frame.col(0));
    plane.c = wall_normal.dot(frame.col(1));
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 offset = corners[i] - point;
        plane.corners[i] = {offset.dot(frame.col(0)), offset.dot(frame.col(1))};
    }
    return plane;
}

double antiderivative(const Plane& plane, double q, double phi) {
    const auto& [distance, a, b, c, corners] = plane;
    return (a * a + 0.5 * q * q * (b * b + c * c)) * phi +
           2.0 * a * q * (b * std::sin(phi) - c * std::cos(phi)) +
           q * q *
               (0.25 * (b * b - c * c) * std::sin(2.0 * phi) - 0.5 * b * c * std::cos(2.0 * phi));
}

bool is_inside(const Plane& plane, const Vec2& p) {
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2& from = plane.corners[i];
        const Vec2 edge = plane.corners[(i + 1) % 3] - from;
        if (edge.x() * (p.y() - from.y()) - edge.y() * (p.x() - from.x()) < 0.0) return false;
    }
    return true;
}

// Angles at which the circle of radius q meets the triangle's outline, sorted.
std::vector<double> crossings(const Plane& plane, double q) {
    std::vector<double> angles;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2& from = plane.corners[i];
        const Vec2 edge = plane.corners[(i + 1) % 3] - from;
        const Vec2 along = edge.normalized();
        const Vec2 foot = from - from.dot(along) * along;
        const double half2 = (q - foot.norm()) * (q + foot.norm());
        if (!(half2 > 0.0)) continue;
        for (const double side : {-1.0, 1.0}) {
            const Vec2 p = foot + side * std::sqrt(half2) * along;
            const double t = (p - from).dot(along);
            if (t >= 0.0 && t <= edge.norm()) angles.push_back(std::atan2(p.y(), p.x()));
        }
    }
    std::sort(angles.begin(), angles.end());
    return angles;
}

double density(const Plane& plane, double range) {
    const double q2 = (range - plane.distance) * (range + plane.distance);
    if (!(q2 > 0.0)) return 0.0;
    const double q = std::sqrt(q2);
    std::vector<double> angles = crossings(plane, q);
    if (angles.empty()) angles.push_back(-kPi);
    angles.push_back(angles.front() + 2.0 * kPi);
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < angles.size(); ++i) {
        const double middle = 0.5 * (angles[i] + angles[i + 1]);
        if (!is_inside(plane, {q * std::cos(middle), q * std::sin(middle)})) continue;
        sum += antiderivative(plane, q, angles[i + 1]) - antiderivative(plane, q, angles[i]);
    }
    return plane.distance * plane.distance * sum / std::pow(range, 7);
}

// Ranges at which the density has a jump, a kink or a square-root onset.
std::vector<double> breakpoints(const Plane& plane) {
    std::vector<double> ranges{plane.distance};
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2& from = plane.corners[i];
        const Vec2 edge = plane.corners[(i + 1) % 3] - from;
        ranges.push_back(std::hypot(plane.distance, from.norm()));
        const double t = -from.dot(edge) / edge.squaredNorm();
        if (t > 0.0 && t < 1.0) {
            ranges.push_back(std::hypot(plane.distance, (from + t * edge).norm()));
        }
    }
    std::sort(ranges.begin(), ranges.end());
    return ranges;
}

// Gauss-Legendre abscissas and weights on [0, 1], by Newton's method on the Legendre polynomial.
std::vector<std::pair<double, double>> gauss_legendre(int count) {
    std::vector<std::pair<double, double>> nodes;
    for (int i = 0; i < count; ++i) {
        double x = std::cos(kPi * (i + 0.75) / (count + 0.5));
        double gradient = 1.0;
        for (int iteration = 0; iteration < 100; ++iteration) {
            const double p = std::legendre(static_cast<unsigned>(count), x);
            const double previous = std::legendre(static_cast<unsigned>(count) - 1U, x);
            gradient = count * (x * p - previous) / (x * x - 1.0);
            const double step = p / gradient;
            x -= step;
            if (std::abs(step) < 1e-15) break;
        }
        nodes.emplace_back(0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * gradient * gradient));
    }
    return nodes;
}

// Integral of the density between two neighbouring breakpoints; u -> 3u^2 - 2u^3 flattens
// square-root behaviour at both ends.
double integrate(const Plane& plane, double from, double to) {
    static const auto kNodes = gauss_legendre(48);
    double sum = 0.0;
    for (const auto& [u, weight] : kNodes) {
        const double x = u * u * (3.0 - 2.0 * u);
        sum += weight * 6.0 * u * (1.0 - u) * density(plane, from + (to - from) * x);
    }
    return sum * (to - from);
}

}  // namespace

std::vector<double> confocal_arcs(const std::array<Vec3, 3>& corners,
                                  const Vec3& wall_point,
                                  const Vec3& wall_normal,
                                  const TimeAxis& axis) {
    const Plane plane = make_plane(corners, wall_point, wall_normal);
    std::vector<double> cuts = breakpoints(plane);
    const double nearest = cuts.front();
    const double farthest = cuts.back();
    std::vector<double> result;
    for (int bin = 0; bin < axis.num_bins; ++bin) {
        const double begin = std::max(nearest, 0.5 * axis.bin_begin_m(bin));
        const double end = std::min(farthest, 0.5 * axis.bin_begin_m(bin + 1));
        double sum = 0.0;
        double from = begin;
        for (const double cut : cuts) {
            if (cut <= from || from >= end) continue;
            const double to = std::min(cut, end);
            sum += integrate(plane, from, to);
            from = to;
        }
        result.push_back(sum);
    }
    return result;
}

}  // namespace test_support
