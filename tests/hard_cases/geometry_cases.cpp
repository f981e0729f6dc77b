// SPDX-License-Identifier: MIT
// Lengths, areas, cosines and rays. Leaks between facets, tiny facets in large scenes and scenes a
// kilometre away: tests/renderer/scene/ray_caster_test.cpp and third_bounce_test.cpp.
#include "renderer/path/random_walk.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/ellipsoid_truth.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/random_geometry.h"
#include "tests/support/shift_cases.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace hard_cases {
namespace {

using core::Vec3;
using truth::Quad;
using truth::QuadVec;

renderer::Object triangle_object(const Vec3& a, const Vec3& b, const Vec3& c) {
    renderer::Object object;
    object.name = "triangle";
    object.mesh.vertices = {a, b, c};
    object.mesh.triangles = {{0, 1, 2}};
    return object;
}

}  // namespace

double path_length_in_all_units() {
    core::Rng rng(test_support::seed_of("path_length_in_all_units"), 0, 0);
    Worst worst;
    for (int i = 0; i < 20'000; ++i) {
        const double size = test_support::power_of_ten(rng, -9.0, 6.0);
        const Vec3 origin =
            test_support::power_of_ten(rng, -9.0, 9.0) * test_support::random_point(rng);
        const auto point = [&](double reach) {
            return Vec3(origin + reach * size * test_support::random_point(rng));
        };
        const renderer::FocusPair foci{point(1.0), point(1.0)};
        const Vec3 x = i % 2 == 0
                           ? point(1.0)
                           : Vec3(foci.a + size * test_support::power_of_ten(rng, -12.0, 0.0) *
                                               test_support::random_point(rng));
        worst.add(truth::relative_error(foci.opl_m(x), truth::opl_of(foci, x)));
    }
    return worst.value();
}

double areas_and_normals_of_slivers() {
    core::Rng rng(test_support::seed_of("areas_and_normals_of_slivers"), 0, 0);
    Worst worst;
    // Each in a scene of its own: beside others, slivers thinner than rounding lie on these.
    for (int i = 0; i < 2000; ++i) {
        const double size = test_support::power_of_ten(rng, -3.0, 3.0);
        const Vec3 a = size * test_support::random_point(rng);
        const Vec3 along = size * test_support::random_point(rng);
        const Vec3 aside =
            test_support::power_of_ten(rng, -8.0, 0.0) * size * test_support::random_point(rng);
        const renderer::Object object =
            triangle_object(a, a + along, a + rng.uniform() * along + aside);
        const renderer::Scene scene = test_support::scene_of({object});
        const renderer::Facet& facet = scene.facet(0);
        const auto& vertices = object.mesh.vertices;
        const QuadVec cross = (QuadVec(vertices[1]) - QuadVec(vertices[0]))
                                  .cross(QuadVec(vertices[2]) - QuadVec(vertices[0]));
        worst.add(truth::relative_error(facet.area_m2, cross.norm() / 2));
        worst.add(truth::relative_error(facet.normal, cross.normalized(), 1));
    }
    return worst.value();
}

double transport_at_grazing_angles() {
    core::Rng rng(test_support::seed_of("transport_at_grazing_angles"), 0, 0);
    Worst worst;
    for (int i = 0; i < 500; ++i) {
        // Seen from the facet's centre, the light stands between 45 degrees and 1e-9 above the
        // plane, and the facet as low above the light's own horizon.
        const Vec3 centre = test_support::random_point(rng);
        const renderer::Object object = triangle_object(
            centre + Vec3(1, 0, 0), centre + Vec3(-0.5, 1, 0), centre + Vec3(-0.5, -1, 0));
        const renderer::Scene scene = test_support::scene_of({object});
        const renderer::RandomWalk walk(scene, 1e-4);
        renderer::PathVertex vertex;
        vertex.point = {centre, 0};
        vertex.normal = scene.facet(0).normal;
        vertex.to_previous = vertex.normal;
        vertex.bsdf = renderer::Lambertian{0.6};
        vertex.throughput = 1.0;
        renderer::PathEndpoints ends;
        ends.light.position = centre + Vec3(0.8, 0.3, test_support::power_of_ten(rng, -9.0, 0.0));
        const Vec3 beside = Vec3(0.3, -0.8, 0.0).normalized();
        ends.light.normal =
            (beside + test_support::power_of_ten(rng, -9.0, 0.0) * (centre - ends.light.position))
                .normalized();

        const QuadVec offset = QuadVec(ends.light.position) - QuadVec(centre);
        const Quad distance2 = offset.dot(offset);
        const Quad cosines = truth::abs(QuadVec(vertex.normal).dot(offset)) *
                             -QuadVec(ends.light.normal).dot(offset) / distance2;
        if (!(cosines > 0)) continue;
        worst.add(truth::relative_error(
            walk.connection_value(vertex, ends),
            Quad(0.6) / truth::pi() * cosines * Quad(ends.light.strength) / distance2));
    }
    return worst.value(400);
}

double distances_of_grazing_rays_far_away() {
    core::Rng rng(test_support::seed_of("distances_of_grazing_rays_far_away"), 0, 0);
    Worst worst;
    for (const double away : {0.0, 1e3, 1e6}) {
        const Vec3 centre = away * Vec3(0.6, -0.7, 0.4);
        const Vec3 a = centre + Vec3(-40, -40, 0);
        const Vec3 b = centre + Vec3(40, -40, 0.1);
        const Vec3 c = centre + Vec3(0, 60, -0.2);
        const renderer::Scene scene = test_support::scene_of({triangle_object(a, b, c)}, centre);
        const QuadVec normal = (QuadVec(b) - QuadVec(a)).cross(QuadVec(c) - QuadVec(a));
        for (int i = 0; i < 300; ++i) {
            // Meets the facet at 1e-4 rad.
            const Vec3 from = centre + Vec3(rng.uniform() - 5.0, rng.uniform() - 5.0, 1e-3);
            const Vec3 direction =
                Vec3(1.0, rng.uniform(), -test_support::power_of_ten(rng, -3.0, 0.0)).normalized();
            const auto hit = scene.rays().first_hit(from, Vec3::UnitZ(), direction);
            if (!hit) continue;
            const Quad expected = normal.dot(QuadVec(a) - QuadVec(from)) / normal.dot(direction);
            worst.add(truth::relative_error(hit->distance_m, expected));
        }
    }
    return worst.value(700);
}

double coplanar_and_touching_facets_in_the_way() {
    // A floor of two coplanar quads and a wall that stands on their common edge: nothing lies
    // between points of one quad, nor between quad and wall down to 0.1 mm from the edge, and the
    // wall hides the quads from each other, but for points that touch it.
    const auto floor = [](double x, double width) {
        return test_support::parallelogram_object({{x, -1, 0}, {width, 0, 0}, {0, 2, 0}});
    };
    const renderer::Object wall =
        test_support::parallelogram_object({{0, -1, 0}, {0, 2, 0}, {0, 0, 1}});
    const renderer::Scene scene = test_support::scene_of({floor(-1, 1), floor(0, 1), wall});
    core::Rng rng(test_support::seed_of("coplanar_and_touching_facets_in_the_way"), 0, 0);
    const Vec3 up = Vec3::UnitZ();
    int wrong = 0;
    for (int i = 0; i < 20'000; ++i) {
        const auto on_floor = [&] {
            return Vec3(
                test_support::power_of_ten(rng, -4.0, -0.01), 1.8 * rng.uniform() - 0.9, 0.0);
        };
        const Vec3 p = on_floor();
        const Vec3 q = on_floor();
        const Vec3 across(-q.x(), q.y(), 0.0);
        const Vec3 on_wall(
            0.0, 1.8 * rng.uniform() - 0.9, test_support::power_of_ten(rng, -4.0, -0.01));
        wrong += scene.rays().is_blocked(p, up, q, up) ? 1 : 0;
        wrong += scene.rays().is_blocked(p, up, on_wall, Vec3::UnitX()) ? 1 : 0;
        wrong += scene.rays().is_blocked(p, up, across, up) ? 0 : 1;
    }
    return wrong;
}

}  // namespace hard_cases
