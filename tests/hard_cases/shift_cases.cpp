// SPDX-License-Identifier: MIT
// Shift mappings at their limits. Which degenerate shifts must be refused, and that none is
// accepted wrongly, is measured by tests/support/hard_shift_cases.h; second roots among them.
#include "renderer/shift/plane_shift.h"
#include "renderer/shift/shift_mapping.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/ellipsoid_truth.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/hard_shift_cases.h"
#include "tests/support/random_geometry.h"
#include "tests/support/statistics.h"

namespace hard_cases {
namespace {

using core::Vec3;
using renderer::FocusPair;
using test_support::ShiftCase;
using truth::Quad;
using truth::QuadVec;

struct PlaneTruth {
    QuadVec displacement;
    Quad jacobian;
};

// The angle on the curve is kept: J = S [dA/(dtau dtheta)]_target / [dA/(dtau dtheta)]_source.
PlaneTruth shift_on_plane(const renderer::Facet& plane,
                          const FocusPair& source,
                          const FocusPair& target,
                          const renderer::ConstraintChange& change) {
    const QuadVec x;
    const Quad opl = truth::opl_of(source, x);
    const auto from = truth::Section::cut(source, opl, plane);
    const auto to =
        truth::Section::cut(target, Quad(change.ratio) * opl + Quad(change.offset_m), plane);
    const Quad theta = from->theta_of(x);
    const QuadVec moved = to->point(truth::cosq(theta), truth::sinq(theta));
    return {
        moved,
        Quad(change.ratio) * to->area_per_opl_and_angle(moved) / from->area_per_opl_and_angle(x)};
}

// Error of position (by the longer segment) and Jacobian of shifts whose foci stand `distance_m`
// away, `apart_m` from each other, and move by `moved_m`; lengths grow by a fraction of the
// distance.
double plane_shift_error(std::string_view seed, double distance_m, double apart_m, double moved_m) {
    core::Rng rng(test_support::seed_of(seed), 0, 0);
    Worst worst;
    const auto near = [&](const Vec3& p, double size_m) {
        return Vec3(p + size_m * test_support::random_point(rng));
    };
    for (int i = 0; i < 1000; ++i) {
        const renderer::Facet plane = test_support::make_facet(
            Vec3::Zero(), near(Vec3::UnitX(), 0.3), near(Vec3::UnitY(), 0.3));
        const Vec3 position = distance_m * Vec3(rng.uniform(), rng.uniform(), 1.0);
        const FocusPair source{near(position, apart_m), near(position, apart_m)};
        const FocusPair target{near(source.a, moved_m), near(source.b, moved_m)};
        const double ratio = std::array{0.2, 1.0, 5.0}[static_cast<std::size_t>(i % 3)];
        const renderer::ConstraintChange change{
            ratio, (1.05 - ratio) * source.opl_m(Vec3::Zero()) + moved_m};
        renderer::ShiftTrace trace;
        const auto found = renderer::shift_on_plane(plane, source, target, change, 1e-16, trace);
        if (!found) continue;
        const PlaneTruth expected = shift_on_plane(plane, source, target, change);
        worst.add(truth::relative_error(found->displacement, expected.displacement, distance_m));
        worst.add(truth::relative_error(found->jacobian, expected.jacobian));
    }
    return worst.value(1000);
}

struct Derivatives {
    QuadVec gradient;                 // in the plane
    std::array<QuadVec, 2> segments;  // unit, towards the foci
    std::array<Quad, 2> per_distance;
    QuadVec normal;

    Derivatives(const renderer::ShiftEnd& end, const QuadVec& x, const QuadVec& plane_normal)
        : normal(plane_normal) {
        std::size_t i = 0;
        for (const Vec3& focus : {end.a, end.y}) {
            const QuadVec r = QuadVec(focus) - x;
            per_distance[i] = 1 / r.norm();
            segments[i] = per_distance[i] * r;
            gradient = gradient - segments[i++];
        }
        gradient = tangential(gradient);
    }
    QuadVec tangential(const QuadVec& v) const { return v - normal.dot(v) * normal; }
    QuadVec hessian_times(const QuadVec& t) const {
        QuadVec sum;
        for (std::size_t i = 0; i < 2; ++i) {
            sum = sum + per_distance[i] * (t - segments[i].dot(t) * segments[i]);
        }
        return tangential(sum);
    }
};

// |det dF/dxi| / |det dF/dxi'| of section 4 of the design, F1 the length, F2 the average gauge; R
// turns within the plane. A determinant of two in-plane rows is n . (row1 x row2).
Quad newton_jacobian(const ShiftCase& c, const Vec3& shifted, const QuadVec& normal) {
    const Quad ratio = c.change.ratio;
    const Derivatives at_source(c.source, c.x.position, normal);
    const Derivatives at_target(c.target, shifted, normal);
    const QuadVec d = QuadVec(shifted) - c.x.position;
    const auto turned = [&](const QuadVec& v) { return normal.cross(v); };
    const QuadVec m = turned(Quad(0.5) * (ratio * at_source.gradient + at_target.gradient));
    const QuadVec by_target = m - Quad(0.5) * at_target.hessian_times(turned(d));
    const QuadVec by_source = (-1) * m - (Quad(0.5) * ratio) * at_source.hessian_times(turned(d));
    const Quad above = normal.dot((ratio * at_source.gradient).cross(by_source));
    const Quad below = normal.dot(at_target.gradient.cross(by_target));
    return truth::abs(above / below);
}

// Of shifts by Newton's method on a scene of one size: the Jacobian against the formula at the
// point found, or the product of both ways' Jacobians against 1.
enum class Compare { WithFormula, WithWayBack };

double newton_error(std::string_view seed, double scale_m, Compare compare) {
    const renderer::Scene scene =
        test_support::scene_of({test_support::tilted_quad(Vec3::Zero(), scale_m)});
    renderer::ShiftSettings settings;
    settings.chart = renderer::Chart::Plane;
    settings.closed_form_on_planes = false;
    const renderer::ShiftMapping mapping(scene, settings);
    core::Rng rng(test_support::seed_of(seed), 0, 0);
    Worst worst;
    renderer::ShiftCounts counts;
    for (int i = 0; i < 1500; ++i) {
        test_support::ShiftCaseSettings draw;
        draw.scale_m = scale_m;
        draw.moved_m = 0.05 * scale_m;
        draw.offset_m = 0.05 * scale_m;
        draw.ratio = std::array{0.2, 1.0, 5.0}[static_cast<std::size_t>(i % 3)];
        draw.confocal = i % 2 == 0;
        const ShiftCase c = test_support::random_shift_case(scene, Vec3::Zero(), draw, rng);
        const auto there = test_support::shift(mapping, c, counts);
        if (!there) continue;
        if (compare == Compare::WithFormula) {
            const renderer::Facet& facet = scene.facet(c.x.facet);
            const QuadVec normal = QuadVec(facet.edge1).cross(facet.edge2).normalized();
            worst.add(truth::relative_error(there->jacobian,
                                            newton_jacobian(c, there->point.position, normal)));
            continue;
        }
        const auto back = test_support::shift(mapping, c.inverse(there->point), counts);
        worst.add(back ? std::abs(there->jacobian * back->jacobian - 1.0) : HUGE_VAL);
    }
    return worst.value(300);
}

}  // namespace

double plane_shift_of_coincident_foci() {
    return plane_shift_error("plane_shift_of_coincident_foci", 1.0, 0.0, 0.02);
}

double plane_shift_of_nearly_coincident_foci() {
    return plane_shift_error("plane_shift_of_nearly_coincident_foci", 1.0, 1e-9, 0.02);
}

double plane_shift_of_foci_a_kilometre_away() {
    return plane_shift_error("plane_shift_of_foci_a_kilometre_away", 1e3, 1.0, 0.02);
}

double newton_shift_determinant() {
    return std::max(newton_error("newton_shift_determinant", 1.0, Compare::WithFormula),
                    newton_error("newton_shift_determinant", 1e-3, Compare::WithFormula));
}

double shift_there_and_back() {
    return std::max(newton_error("shift_there_and_back", 1.0, Compare::WithWayBack),
                    newton_error("shift_there_and_back", 1e-3, Compare::WithWayBack));
}

double hard_shifts_accepted_wrongly() {
    return static_cast<double>(test_support::HardShiftBench().run(0, 200'000).wrong);
}

}  // namespace hard_cases
