// SPDX-License-Identifier: MIT
// Triangles seen from a wall point: exact arcs and the kernel that stands for them. Facets at
// grazing angles, around the tangent point, of aspect 1e6 and next to the wall:
// tests/renderer/triangle/triangle_histogram_test.cpp.
#include "renderer/core/random.h"
#include "renderer/triangle/triangle_histogram.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/extended_precision.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/exact_arcs.h"
#include "tests/support/random_geometry.h"
#include "tests/support/single_triangle.h"
#include "tests/support/statistics.h"

#include <array>
#include <vector>

namespace hard_cases {
namespace {

using core::TimeAxis;
using core::Vec3;
using renderer::TriangleKnots;
using truth::Quad;
using truth::QuadVec;

// Integrals over a triangle of the confocal weight cos_w^2 cos_p^2 / r^4 and of length times it.
struct Integrals {
    Quad energy = 0;
    Quad moment = 0;
};

double confocal_weight(const Vec3& d, const Vec3& normal) {
    const double cosines = d.z() * normal.dot(d);
    return cosines * cosines / std::pow(d.squaredNorm(), 4);
}

// Seven points are exact to fifth order: all that matters to a triangle of
// 1e-3 of its distance.
Integrals integrate(const std::array<Vec3, 3>& corners) {
    const QuadVec cross = (QuadVec(corners[1]) - QuadVec(corners[0]))
                              .cross(QuadVec(corners[2]) - QuadVec(corners[0]));
    const QuadVec normal = cross.normalized();
    Integrals sums;
    const auto add = [&](Quad fraction, const std::array<Quad, 3>& b) {
        const QuadVec d =
            b[0] * QuadVec(corners[0]) + b[1] * QuadVec(corners[1]) + b[2] * QuadVec(corners[2]);
        const Quad r2 = d.dot(d);
        const Quad cosines = d.z * normal.dot(d);
        const Quad weight = fraction * cross.norm() / 2 * cosines * cosines / (r2 * r2 * r2 * r2);
        sums.energy += weight;
        sums.moment += weight * 2 * truth::sqrtq(r2);
    };
    add(Quad(9) / 40, {Quad(1) / 3, Quad(1) / 3, Quad(1) / 3});
    const Quad root = truth::sqrtq(15);
    for (const Quad sign : {Quad(-1), Quad(1)}) {
        const Quad a = (6 + sign * root) / 21;
        for (std::size_t i = 0; i < 3; ++i) {
            std::array<Quad, 3> b{a, a, a};
            b[i] = 1 - 2 * a;
            add((155 + sign * root) / 1200, b);
        }
    }
    return sums;
}

/// A triangle of a size, 0.5 to 1.5 m before the wall point at the origin; every second one a
/// sliver.
std::array<Vec3, 3> random_triangle(core::Rng& rng, double size_m, double sliver) {
    const Vec3 centre(rng.uniform() - 0.5, rng.uniform() - 0.5, 0.5 + rng.uniform());
    const Vec3 along = size_m * test_support::random_point(rng);
    const Vec3 aside = size_m * test_support::random_point(rng);
    const Vec3 third = rng.uniform() < 0.5 ? aside : Vec3(0.4 * along + sliver * aside);
    return {centre, centre + along, centre + third};
}

}  // namespace

double exact_arcs_of_tiny_triangles() {
    core::Rng rng(test_support::seed_of("exact_arcs_of_tiny_triangles"), 0, 0);
    Worst worst;
    for (int i = 0; i < 200; ++i) {
        const auto corners =
            random_triangle(rng, test_support::power_of_ten(rng, -6.0, -3.5), 1e-2);
        const double reach =
            4.0 * (corners[1] - corners[0]).norm() + 4.0 * (corners[2] - corners[0]).norm();
        const TimeAxis axis{2.0 * corners[0].norm() - reach, reach, 2};
        const auto bins = test_support::confocal_arcs(corners, Vec3::Zero(), Vec3::UnitZ(), axis);
        worst.add(truth::relative_error(bins[0] + bins[1], integrate(corners).energy));
    }
    return worst.value();
}

double kernel_of_tiny_triangles_and_slivers() {
    core::Rng rng(test_support::seed_of("kernel_of_tiny_triangles_and_slivers"), 0, 0);
    Worst worst;
    for (int i = 0; i < 2000; ++i) {
        const auto c = random_triangle(rng, test_support::power_of_ten(rng, -6.0, -3.0), 1e-6);
        const Vec3 area_vector = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]);
        const Vec3 normal = area_vector.normalized();
        TriangleKnots at_corners;
        TriangleKnots at_midpoints;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 middle = 0.5 * (c[k] + c[(k + 1) % 3]);
            at_corners.opl_m[k] = 2.0 * c[k].norm();
            at_corners.weight[k] = confocal_weight(c[k], normal);
            at_midpoints.opl_m[k] = 2.0 * middle.norm();
            at_midpoints.weight[k] = confocal_weight(middle, normal);
        }
        const TriangleKnots knots = renderer::match_midpoints(at_corners, at_midpoints);
        // Of bins of 1 mm: energy, and the mean length to a part of a bin.
        const TimeAxis axis{0.0, 0.001, 5000};
        std::vector<double> histogram(5000, 0.0);
        test_support::add_triangle(knots, area_vector.norm(), axis, histogram);
        double energy = 0.0;
        for (const double value : histogram) energy += value;
        double moment = 0.0;  // of the linear triangle: A/12 sum K_j r_k (1 + [j == k])
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = 0; k < 3; ++k) {
                moment += knots.weight[j] * knots.opl_m[k] * (j == k ? 2.0 : 1.0);
            }
        }
        const Integrals expected = integrate(c);
        worst.add(truth::relative_error(energy, expected.energy));
        worst.add(truth::relative_error(moment * area_vector.norm() / 12.0, expected.moment));
    }
    return worst.value();
}

double exact_arcs_of_coplanar_triangles() {
    // The wall point lies in the triangle's plane: no light at all.
    Worst worst;
    for (const double tilt : {0.0, 0.4, 1.5}) {
        const Vec3 along(std::sin(tilt), 0.0, std::cos(tilt));
        const std::array<Vec3, 3> corners{
            0.5 * along, 0.9 * along + 0.3 * Vec3::UnitY(), 0.7 * along - 0.2 * Vec3::UnitY()};
        for (const double value :
             test_support::confocal_arcs(corners, Vec3::Zero(), Vec3::UnitZ(), {0.0, 0.01, 300})) {
            worst.add(std::abs(value));
        }
    }
    return worst.value();
}

double exact_arcs_of_a_facet_of_kilometres() {
    // As good as a plane: with z its distance, 2 pi z^4 r^-7 per range, so pi z^4 (z^-6 - R^-6)/3
    // up to the range R.
    Worst worst;
    for (const double z : {0.5, 1.0, 3.0}) {
        const std::array<Vec3, 3> corners{Vec3(-4e3, -3e3, z), Vec3(5e3, -3e3, z), Vec3(0, 4e3, z)};
        const TimeAxis axis{0.0, 0.04 * z, 1000};
        double found = 0.0;
        for (const double value :
             test_support::confocal_arcs(corners, Vec3::Zero(), Vec3::UnitZ(), axis)) {
            found += value;
        }
        const Quad z2 = Quad(z) * Quad(z);
        const Quad end = Quad(axis.bin_width_m) * 500;
        const Quad end2 = end * end;
        const Quad expected =
            truth::pi() * z2 * z2 / 3 * (1 / (z2 * z2 * z2) - 1 / (end2 * end2 * end2));
        worst.add(truth::relative_error(found, expected));
    }
    return worst.value();
}

}  // namespace hard_cases
