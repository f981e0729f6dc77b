// SPDX-License-Identifier: MIT
// Ellipsoidal connections, derivatives of the length and the velocity near the foci. Random
// degenerate configurations at large are those of tests/support/ellipsoid_stress.h.
#include "renderer/shift/path_functional.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/ellipsoid_truth.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/ellipsoid_stress.h"
#include "tests/support/inverse_sampling.h"
#include "tests/support/statistics.h"

namespace hard_cases {
namespace {

using core::Vec3;
using renderer::Facet;
using renderer::FocusPair;
using truth::Quad;
using truth::QuadVec;

/// A facet of about 1 m, 1 m before the foci at the origin.
Facet facet_before(core::Rng& rng) {
    const auto corner = [&] { return Vec3(test_support::random_point(rng) + Vec3(0, 0, 2.0)); };
    const Vec3 a = corner();
    const Vec3 b = corner();
    return test_support::make_facet(a, b, corner());
}

/// Density 0 means that no vertex is drawn there: another technique's business, and no error.
void add_density_error(const FocusPair& foci, const Facet& facet, const Vec3& x, Worst& worst) {
    const double found = renderer::pdf_ellipsoid(foci, facet, x);
    if (found == 0.0) return;
    worst.add(truth::relative_error(found, truth::pdf_area_per_pdf_opl(foci, facet, x)));
}

// At 10^from .. 10^to from where the plane mirrors one focus to the other.
double tangent_point_error(std::string_view seed, double from, double to) {
    core::Rng rng(test_support::seed_of(seed), 0, 0);
    Worst worst;
    for (int i = 0; i < 3000; ++i) {
        const FocusPair foci{Vec3(-0.3, 0.1, 0.0), Vec3(0.4, 0.2, 0.3)};
        const Facet facet = test_support::make_facet({-2, -2, 1}, {3, -2, 1}, {0, 4, 1});
        // The foci stand 1 m and 0.7 m above the plane: light is mirrored where 10/17 of the way
        // from one foot to the other is done.
        const Vec3 tangent(-0.3 + 0.7 / 1.7, 0.1 + 0.1 / 1.7, 1.0);
        const double angle = 2.0 * core::kPi * rng.uniform();
        const Vec3 offset(std::cos(angle), std::sin(angle), 0.0);
        const double reach = test_support::power_of_ten(rng, from, to);
        add_density_error(foci, facet, tangent + reach * offset, worst);
    }
    return worst.value(2500);
}

// At 10^from .. 10^to from the segment between foci 1 m apart, in a plane that holds it or crosses
// it: tau/2c - 1 is twice the distance's square.
double segment_error(std::string_view seed, double from, double to) {
    core::Rng rng(test_support::seed_of(seed), 0, 0);
    Worst worst;
    for (int i = 0; i < 3000; ++i) {
        const FocusPair foci{Vec3(-0.5, 0.0, 0.0), Vec3(0.5, 0.0, 0.0)};
        const double tilt = i % 2 == 0 ? 0.0 : rng.uniform();
        const Vec3 along(std::cos(tilt), 0.0, -std::sin(tilt));
        const Facet facet = test_support::make_facet(
            -2.0 * along - Vec3::UnitY(), 2.0 * along - Vec3::UnitY(), 3.0 * Vec3::UnitY());
        const double reach = test_support::power_of_ten(rng, from, to);
        const double middle = i % 2 == 0 ? 0.8 * rng.uniform() - 0.4 : 0.0;
        add_density_error(foci, facet, middle * along + reach * Vec3::UnitY(), worst);
    }
    return worst.value(2500);
}

struct LengthErrors {
    double value = 0.0;
    double gradient = 0.0;  ///< in units
    double hessian = 0.0;   ///< relative to 1/distance
};

// Gradient -(u_a + u_y), Hessian sum (I - u u^T)/d, applied to a direction.
LengthErrors length_errors(const Vec3& a, const Vec3& y, const Vec3& direction) {
    const renderer::OpticalLength length{a, y};
    const auto e = length.expand(Vec3::Zero(), Vec3::Zero());
    QuadVec gradient;
    QuadVec product;
    Quad per_distance = 0;
    Quad value = 0;
    for (const QuadVec r : {QuadVec(a), QuadVec(y)}) {
        const Quad d = r.norm();
        const QuadVec u = (1 / d) * r;
        value += d;
        per_distance += 1 / d;
        gradient = gradient - u;
        product = product + (1 / d) * (QuadVec(direction) - u.dot(direction) * u);
    }
    return {truth::relative_error(e.value, value),
            truth::relative_error(e.gradient, gradient, 1),
            truth::relative_error(e.hessian_times(direction), product, per_distance)};
}

}  // namespace

double density_with_nearly_coincident_foci() {
    core::Rng rng(test_support::seed_of("density_with_nearly_coincident_foci"), 0, 0);
    Worst worst;
    for (int i = 0; i < 3000; ++i) {
        const double apart = i % 10 == 0 ? 0.0 : test_support::power_of_ten(rng, -18.0, -3.0);
        const Vec3 a = test_support::random_point(rng);
        const FocusPair foci{a, a + apart * test_support::random_point(rng)};
        const Facet facet = facet_before(rng);
        const double b1 = 0.5 * rng.uniform();
        add_density_error(foci, facet, facet.point(b1, 0.5 * rng.uniform()), worst);
    }
    return worst.value(2500);
}

double density_near_the_tangent_point() {
    return tangent_point_error("density_near_the_tangent_point", -4.0, -1.0);
}

double density_at_the_tangent_point() {
    return tangent_point_error("density_at_the_tangent_point", -7.0, -4.0);
}

double density_near_the_segment_of_the_foci() {
    return segment_error("density_near_the_segment_of_the_foci", -4.0, -1.0);
}

double density_on_the_segment_of_the_foci() {
    return segment_error("density_on_the_segment_of_the_foci", -7.0, -4.0);
}

double density_beside_a_focus_on_the_surface() {
    core::Rng rng(test_support::seed_of("density_beside_a_focus_on_the_surface"), 0, 0);
    Worst worst;
    for (int i = 0; i < 3000; ++i) {
        const Facet facet = facet_before(rng);
        const Vec3 focus = facet.point(0.3, 0.3);
        const FocusPair foci{focus, i % 2 == 0 ? focus : test_support::random_point(rng)};
        const double reach = test_support::power_of_ten(rng, -5.0, -1.0);
        const double angle = 2.0 * core::kPi * rng.uniform();
        const Vec3 x =
            focus + reach * (std::cos(angle) * facet.edge1 + std::sin(angle) * facet.edge2);
        add_density_error(foci, facet, x, worst);
    }
    return worst.value(2000);
}

double drawn_length_of_kilometre_segments() {
    core::Rng rng(test_support::seed_of("drawn_length_of_kilometre_legs"), 0, 0);
    Worst worst;
    for (int i = 0; i < 3000; ++i) {
        const Vec3 far = 1e3 * test_support::random_point(rng) - Vec3(0, 0, 1e3);
        const FocusPair foci{far, far + test_support::power_of_ten(rng, -3.0, 2.0) * Vec3::UnitX()};
        const Facet facet = facet_before(rng);
        const double opl = foci.opl_m(facet.point(0.3, 0.3));
        const auto drawn = renderer::sample_ellipsoid(foci, opl, facet, rng.uniform());
        if (!drawn) continue;
        worst.add(truth::relative_error(truth::opl_of(foci, drawn->position), opl));
    }
    return worst.value(2000);
}

double inverse_of_drawn_vertices() {
    core::Rng rng(test_support::seed_of("inverse_of_drawn_vertices"), 0, 0);
    Worst worst;
    for (int i = 0; i < 5000; ++i) {
        const double apart = i % 3 == 0 ? 0.0 : test_support::power_of_ten(rng, -16.0, 0.3);
        const Vec3 a = test_support::random_point(rng);
        const FocusPair foci{a, a + apart * test_support::random_point(rng)};
        const Facet facet = facet_before(rng);
        const double u = rng.uniform();
        const auto drawn =
            renderer::sample_ellipsoid(foci, foci.opl_m(facet.point(0.3, 0.3)), facet, u);
        const auto again =
            drawn ? test_support::invert_ellipsoid(foci, facet, drawn->position) : std::nullopt;
        worst.add(again ? std::abs(*again - u) : HUGE_VAL);
    }
    return worst.value();
}

double random_connections_that_are_wrong() {
    return static_cast<double>(
        test_support::stress_ellipsoid(100'000,
                                       test_support::seed_of("random_connections_that_are_wrong"))
            .bad);
}

double gradients_of_the_length_beside_a_focus() {
    core::Rng rng(test_support::seed_of("gradients_of_the_length_beside_a_focus"), 0, 0);
    Worst worst;
    for (int i = 0; i < 20'000; ++i) {
        const Vec3 a =
            test_support::power_of_ten(rng, -12.0, 3.0) * test_support::random_point(rng);
        const Vec3 y =
            test_support::power_of_ten(rng, -12.0, 3.0) * test_support::random_point(rng);
        // Along the segment, where the Hessian vanishes, and across.
        const Vec3 t =
            i % 2 == 0 ? Vec3(a.normalized()) : test_support::random_point(rng).normalized();
        const LengthErrors e = length_errors(a, y, t);
        for (const double error : {e.value, e.gradient, e.hessian}) worst.add(error);
    }
    return worst.value();
}

double gradient_of_the_length_between_the_foci() {
    core::Rng rng(test_support::seed_of("gradient_of_the_length_between_the_foci"), 0, 0);
    Worst worst;
    for (int i = 0; i < 5000; ++i) {
        const Vec3 u = test_support::random_point(rng).normalized();
        const double aside = test_support::power_of_ten(rng, -8.0, -1.0);
        const Vec3 a = u + aside * test_support::random_point(rng);
        const Vec3 y = -rng.uniform() * u;
        const auto e = renderer::OpticalLength{a, y}.expand(Vec3::Zero(), Vec3::Zero());
        const QuadVec truth_gradient = (-1) * (QuadVec(a).normalized() + QuadVec(y).normalized());
        worst.add(truth::relative_error(e.gradient, truth_gradient, truth_gradient.norm()));
    }
    return worst.value();
}

double gradients_of_the_velocity_beside_a_focus() {
    core::Rng rng(test_support::seed_of("gradients_of_the_velocity_beside_a_focus"), 0, 0);
    Worst worst;
    for (int i = 0; i < 20'000; ++i) {
        const std::array<Vec3, 2> r{
            Vec3(test_support::power_of_ten(rng, -9.0, 3.0) * test_support::random_point(rng)),
            Vec3(test_support::power_of_ten(rng, -9.0, 3.0) * test_support::random_point(rng))};
        // Along the segment the gradient vanishes.
        const std::array<Vec3, 2> w{
            i % 2 == 0 ? Vec3(3.0 * r[0].normalized()) : test_support::random_point(rng),
            test_support::random_point(rng)};
        const Vec3 t = test_support::random_point(rng);
        const auto e =
            renderer::PathVelocity{r[0], r[1], w[0], w[1]}.expand(Vec3::Zero(), Vec3::Zero());
        Quad value = 0;
        QuadVec gradient;
        QuadVec product;
        Quad per_distance = 0;
        Quad per_distance2 = 0;
        for (std::size_t k = 0; k < 2; ++k) {
            const Quad d = QuadVec(r[k]).norm();
            const QuadVec u = (1 / d) * QuadVec(r[k]);
            const Quad c = u.dot(w[k]);
            value += c;
            gradient = gradient - (1 / d) * (QuadVec(w[k]) - c * u);
            const QuadVec h = QuadVec(w[k]).dot(t) * u + u.dot(t) * QuadVec(w[k]) + c * QuadVec(t) -
                              (3 * c * u.dot(t)) * u;
            product = product - (1 / (d * d)) * h;
            per_distance += QuadVec(w[k]).norm() / d;
            per_distance2 += QuadVec(w[k]).norm() / (d * d);
        }
        worst.add(truth::relative_error(e.value, value, w[0].norm() + w[1].norm()));
        worst.add(truth::relative_error(e.gradient, gradient, per_distance));
        worst.add(truth::relative_error(e.hessian_times(t), product, per_distance2));
    }
    return worst.value();
}

}  // namespace hard_cases
