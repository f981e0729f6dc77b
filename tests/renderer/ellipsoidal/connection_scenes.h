// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/ellipsoidal/connection_technique.h"
#include "tests/support/random_geometry.h"
#include "tests/support/test_scenes.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace connection_test {

/// Small random triangles above the wall z = 0; the second object has a closed surface. No wall
/// surface: the points lie apart from it.
inline renderer::Scene random_scene(core::Rng& rng, int num_triangles) {
    renderer::SceneGeometry geometry;
    renderer::Object& soup = geometry.objects.emplace_back();
    soup.name = "soup";
    for (int i = 0; i < num_triangles; ++i) {
        const core::Vec3 center = test_support::random_point(rng) + core::Vec3(0.0, 0.0, 1.6);
        const auto first = static_cast<std::uint32_t>(soup.mesh.vertices.size());
        for (int k = 0; k < 3; ++k) {
            soup.mesh.vertices.push_back(center + 0.1 * test_support::random_point(rng));
        }
        soup.mesh.triangles.push_back({first, first + 1, first + 2});
    }
    geometry.objects.push_back(
        test_support::sphere_object(core::Vec3(0.3, 0.2, 1.2), 0.25, 1, 1.0));
    geometry.objects.back().name = "ball";
    return {std::move(geometry),
            test_support::confocal_scan({core::Vec3(9, 9, 0)}),
            renderer::RelayWall{}};
}

/// What the hierarchy is asked: for facets with lengths of an interval between two ends.
struct Question {
    renderer::ConnectionEnds ends;
    renderer::OplBand lengths;
};

/// Ends on the wall, one of them coincident, and in space; intervals from narrow to everything.
inline std::vector<Question> questions(core::Rng& rng) {
    std::vector<Question> all;
    for (int i = 0; i < 6; ++i) {
        core::Vec3 a = test_support::random_point(rng);
        core::Vec3 b = i % 2 == 0 ? a : test_support::random_point(rng);
        Question q;
        q.ends = {{a, b}, core::Vec3::UnitZ(), core::Vec3::UnitZ()};
        q.ends.foci.a.z() = q.ends.foci.b.z() = 0.0;
        if (i == 3) q.ends.normal_a = core::Vec3(0.0, 0.8, 0.6);
        if (i == 5) q.ends.normal_a = q.ends.normal_b = core::Vec3::Zero();
        const double width = i < 2 ? 10.0 : 0.02 * (i - 1);
        q.lengths = {i < 2 ? 0.0 : 3.0, (i < 2 ? 0.0 : 3.0) + width};
        all.push_back(q);
    }
    return all;
}

inline renderer::ConnectionTechnique technique_of(const renderer::Scene& scene) {
    renderer::RenderSettings settings;
    return {scene,
            renderer::ExcludedFacets::of(scene, core::TimeAxis{}, settings),
            test_support::confocal_scan({core::Vec3(9, 9, 0)})};
}

/// Cosines at both ends and both cosines at the point over the squared distances; 0 where a side is
/// not lit.
inline double carried(const renderer::ConnectionEnds& ends,
                      const renderer::Facet& facet,
                      const core::Vec3& x) {
    const auto factor = [&](const core::Vec3& focus, const core::Vec3& normal, double& side) {
        const core::Vec3 offset = x - focus;
        const double distance = offset.norm();
        side = -facet.normal.dot(offset) / distance;
        const double at_end = normal.isZero(0.0) ? 1.0 : normal.dot(offset) / distance;
        return std::max(0.0, at_end) / (distance * distance);
    };
    double side_a = 0.0;
    double side_b = 0.0;
    const double a = factor(ends.foci.a, ends.normal_a, side_a);
    const double b = factor(ends.foci.b, ends.normal_b, side_b);
    return side_a * side_b > 0.0 ? a * b * side_a * side_b : 0.0;
}

/// The ball is closed: its inside is never lit, and the hierarchy may leave it out.
inline bool is_inside_of_ball(const renderer::Scene& scene,
                              std::uint32_t facet,
                              const renderer::ConnectionEnds& ends) {
    const renderer::Facet& f = scene.facet(facet);
    if (scene.object_of(facet).name != "ball") return false;
    core::Vec3 middle = core::Vec3::Zero();
    const auto& vertices = scene.object_of(facet).mesh.vertices;
    for (const core::Vec3& v : vertices) middle += v / static_cast<double>(vertices.size());
    const core::Vec3 outward = f.corner - middle;
    const double side = f.normal.dot(outward) > 0.0 ? 1.0 : -1.0;
    return side * f.normal.dot(ends.foci.a - f.corner) <= 0.0;
}

}  // namespace connection_test
