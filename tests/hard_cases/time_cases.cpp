// SPDX-License-Identifier: MIT
// Bins, gates and bounds of lengths. Axes before and behind the light for every reconstruction
// method: tests/nlos/reconstruction_hard_cases_test.cpp.
#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/velocity_axis.h"
#include "renderer/film/time_gate.h"
#include "renderer/render.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/ellipsoid_truth.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/random_geometry.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <numeric>

namespace hard_cases {
namespace {

using core::Vec3;
using truth::Quad;
using truth::QuadVec;

/// How far outside its bin a length lies [bins].
double outside(const core::TimeAxis& axis, Quad opl, int bin) {
    const Quad position = (opl - Quad(axis.opl_start_m)) / Quad(axis.bin_width_m);
    return truth::to_double(std::max({Quad(bin) - position, position - Quad(bin + 1), Quad(0)}));
}

using renderer::Estimator;

/// A triangle 1 m before the wall whose shortest way to and from the origin is known: 2 m; all
/// lengths times `unit`.
core::Transient rendered_tangent_triangle(const core::TimeAxis& axis,
                                          double unit = 1.0,
                                          Estimator method = Estimator::ThirdBounce) {
    renderer::SceneGeometry geometry;
    geometry.objects.emplace_back();
    geometry.objects[0].name = "triangle";
    geometry.objects[0].mesh.vertices = {{-0.4, -0.3, 1.0}, {0.5, -0.2, 1.0}, {0.0, 0.4, 1.0}};
    for (Vec3& vertex : geometry.objects[0].mesh.vertices) vertex *= unit;
    geometry.objects[0].mesh.triangles = {{0, 1, 2}};
    const core::WallScan scan = test_support::confocal_scan({Vec3::Zero()});
    renderer::RenderSettings settings;
    settings.method = method;
    settings.samples = 512;
    if (method == Estimator::ThirdBounce) settings.target_error = 3e-3;
    const renderer::Scene scene(std::move(geometry), scan, renderer::RelayWall{});
    return renderer::render(scene, scan, axis, settings, {}).capture.transient;
}

double sum_of(const core::Transient& transient) {
    return std::accumulate(transient.values().begin(), transient.values().end(), 0.0);
}

}  // namespace

double bins_of_kilometre_segments() {
    core::Rng rng(test_support::seed_of("bins_of_kilometre_legs"), 0, 0);
    Worst worst;
    core::WallScan scan = test_support::confocal_scan({Vec3::Zero()});
    scan.opl_origin = core::OplOrigin::Device;
    for (int i = 0; i < 20'000; ++i) {
        scan.laser_position = 1e3 * test_support::random_point(rng);
        scan.detector_position = scan.laser_position + test_support::random_point(rng);
        const Vec3 p = test_support::random_point(rng);
        const Quad exact = QuadVec(scan.laser_position).norm() +
                           QuadVec(scan.detector_position).norm() + 2 * QuadVec(p).norm();
        const double opl = scan.device_segments_m(0) + 2.0 * p.norm();
        worst.add(truth::relative_error(opl, exact));
        // A bin of 1 mm beyond 1 km is 1e-6 of the length; rounding may move edges by 1e-9 bins.
        const core::TimeAxis axis{std::floor(opl) - 1.0, 0.001, 4000};
        const auto bin = axis.bin_of(opl);
        worst.add(bin ? 1e-3 * outside(axis, exact, *bin) : HUGE_VAL);
    }
    return worst.value();
}

double edges_of_tiny_and_huge_bins() {
    core::Rng rng(test_support::seed_of("edges_of_tiny_and_huge_bins"), 0, 0);
    Worst worst;
    for (int i = 0; i < 20'000; ++i) {
        const double width = test_support::power_of_ten(rng, -12.0, 9.0);
        const core::TimeAxis axis{width * 1e6 * (2.0 * rng.uniform() - 1.0),
                                  width,
                                  1 + static_cast<int>(1e5 * rng.uniform())};
        const int bin = static_cast<int>(rng.uniform() * axis.num_bins);
        const Quad begin = Quad(axis.opl_start_m) + Quad(bin) * Quad(width);
        worst.add(truth::relative_error(axis.bin_begin_m(bin), begin, width));
        for (const double opl : {axis.bin_begin_m(bin), axis.bin_center_m(bin)}) {
            const auto found = axis.bin_of(opl);
            if (found) worst.add(outside(axis, opl, *found));
            if (!found && bin > 0) worst.add(HUGE_VAL);
        }
        // Gates of neighbouring bins meet: their common edge belongs to one of them.
        const auto gate = [&](int k) {
            return renderer::TimeGate::of_bin(axis, k, renderer::GateShape::Box);
        };
        worst.add(std::abs(gate(bin).end_m() - gate(bin + 1).begin_m()) / width);
    }
    return worst.value();
}

double edges_of_the_velocity_axis() {
    const core::VelocityAxis axis{-10.0, 0.1, 200};
    Worst worst;
    for (int bin = -1; bin <= axis.num_bins; ++bin) {
        for (const double part : {1e-9, 0.5, 1.0 - 1e-9}) {
            const auto found = axis.bin_of(axis.bin_begin_m_per_s(bin + part));
            const bool is_on_axis = bin >= 0 && bin < axis.num_bins;
            worst.add(found.has_value() != is_on_axis || (found && *found != bin) ? 1.0 : 0.0);
        }
    }
    for (const double velocity : {-10.0, -0.0, 0.0, 9.99}) {
        worst.add(axis.bin_of(velocity) ? 0.0 : 1.0);
    }
    for (const double velocity : {10.0, std::nextafter(-10.0, -11.0), double(NAN), HUGE_VAL}) {
        worst.add(axis.bin_of(velocity) ? 1.0 : 0.0);
    }
    // Frequency shifts of a walking hand: 1e-9 of the carrier.
    for (const double velocity : {1e-9, 1.3, -299.0}) {
        const Quad expected = -Quad(193e12) * Quad(velocity) / 299792458;
        worst.add(truth::relative_error(core::frequency_shift_hz(193e12, velocity), expected));
    }
    return worst.value();
}

double bounds_of_lengths_over_facets() {
    core::Rng rng(test_support::seed_of("bounds_of_lengths_over_facets"), 0, 0);
    Worst worst;
    for (int i = 0; i < 3000; ++i) {
        const double size = test_support::power_of_ten(rng, -3.0, 3.0);
        const auto point = [&] { return Vec3(size * test_support::random_point(rng)); };
        renderer::FocusPair foci{point(), point()};
        const renderer::Facet facet = test_support::make_facet(point(), point(), point());
        if (i % 4 == 0) foci.a = facet.corner;
        if (i % 4 == 1) foci.a = foci.b = facet.point(1.0 / 3.0, 1.0 / 3.0);
        const renderer::OplBand band = renderer::opl_band(foci, facet);
        // Pattern search for the shortest length within the triangle.
        double b1 = 1.0 / 3.0;
        double b2 = 1.0 / 3.0;
        Quad least = truth::opl_of(foci, facet.point(b1, b2));
        for (double step = 0.25; step > 1e-5; step *= 0.5) {
            for (int tries = 0; tries < 8; ++tries) {
                const double angle = 0.25 * core::kPi * tries;
                const double n1 = std::clamp(b1 + step * std::cos(angle), 0.0, 1.0);
                const double n2 = std::clamp(b2 + step * std::sin(angle), 0.0, 1.0 - n1);
                const Quad found = truth::opl_of(foci, facet.point(n1, n2));
                if (found < least) {
                    least = found;
                    b1 = n1;
                    b2 = n2;
                }
            }
        }
        const Quad beyond = std::max(Quad(band.low_m) - least, least - Quad(band.high_m));
        worst.add(truth::to_double(std::max(Quad(0), beyond) / Quad(band.high_m)));
        worst.add(std::isfinite(band.low_m + band.high_m) ? 0.0 : HUGE_VAL);
    }
    return worst.value();
}

double light_before_the_first_arrival() {
    // The axis ends where light begins, to rounding; or 1 mm before.
    const double energy = sum_of(rendered_tangent_triangle({1.9, 0.02, 50}));
    Worst worst;
    worst.add(sum_of(rendered_tangent_triangle({0.0, 0.02, 100})) / energy);
    for (const Estimator method :
         {Estimator::ThirdBounce, Estimator::Path, Estimator::Ellipsoidal, Estimator::Restir}) {
        worst.add(sum_of(rendered_tangent_triangle({0.0, 1.999, 1}, 1.0, method)) / energy);
        const double after = sum_of(rendered_tangent_triangle({2.0, 1.0, 1}, 1.0, method));
        worst.add(std::abs(after / energy - 1.0) < 0.2 ? 0.0 : HUGE_VAL);
    }
    return worst.value();
}

double energy_of_tiny_and_huge_bins() {
    const double energy = sum_of(rendered_tangent_triangle({1.9, 0.02, 50}));
    Worst worst;
    // Bins of 0.2 mm; one of a million kilometres; an axis that starts at the tangent point.
    for (const core::TimeAxis& axis :
         {core::TimeAxis{1.99, 2e-4, 2000}, {0.0, 1e9, 1}, {2.0, 0.4, 1}}) {
        worst.add(truth::relative_error(sum_of(rendered_tangent_triangle(axis)), energy));
    }
    return worst.value();
}

double third_bounce_in_all_units() {
    // Radiance falls with the square of the unit; powers of 2 round nothing.
    const core::Transient metres = rendered_tangent_triangle({1.99, 0.02, 50});
    const double whole = sum_of(metres);
    Worst worst;
    for (const double unit : {0x1p-20, 0x1p-10, 0x1p10, 0x1p20}) {
        const core::Transient other =
            rendered_tangent_triangle({1.99 * unit, 0.02 * unit, 50}, unit);
        for (std::size_t i = 0; i < 50; ++i) {
            worst.add(truth::relative_error(
                Quad(other.values()[i]) * Quad(unit) * Quad(unit), metres.values()[i], whole));
        }
    }
    return worst.value();
}

}  // namespace hard_cases
