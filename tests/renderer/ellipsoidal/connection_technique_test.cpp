// SPDX-License-Identifier: MIT
// The technique as a whole: how closely draws follow what facets carry, and that they lose nothing.
#include "renderer/ellipsoidal/connection_technique.h"

#include "renderer/core/sampling.h"
#include "tests/renderer/ellipsoidal/connection_scenes.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using connection_test::carried;
using connection_test::is_inside_of_ball;
using connection_test::Question;
using connection_test::questions;
using connection_test::random_scene;
using connection_test::technique_of;
using core::Vec2;
using core::Vec3;
using renderer::ConnectionEnds;
using renderer::OplBand;
using renderer::Scene;

// The walls of a room, metres long, and a ball of many facets in it; no side is told apart.
Scene room_with_ball() {
    renderer::SceneGeometry geometry;
    const auto add_wall = [&](const Vec3& corner, const Vec3& edge1, const Vec3& edge2) {
        geometry.objects.push_back(test_support::parallelogram_object({corner, edge1, edge2}));
    };
    add_wall(Vec3(-1, -1, -1), Vec3(2, 0, 0), Vec3(0, 2, 0));
    add_wall(Vec3(-1, -1, -1), Vec3(0, 2, 0), Vec3(0, 0, 2));
    add_wall(Vec3(1, -1, -1), Vec3(0, 2, 0), Vec3(0, 0, 2));
    add_wall(Vec3(-1, -1, -1), Vec3(2, 0, 0), Vec3(0, 0, 2));
    add_wall(Vec3(-1, 1, -1), Vec3(2, 0, 0), Vec3(0, 0, 2));
    geometry.objects.push_back(test_support::sphere_object(Vec3(-0.4, -0.6, -0.5), 0.2, 3, 1.0));
    geometry.objects.back().name = "ball";
    return {
        std::move(geometry), test_support::confocal_scan({Vec3(9, 9, 0)}), renderer::RelayWall{}};
}

// How far draws are from following what facets carry, visibility ignored: E[(carried / pdf)^2] /
// E[carried / pdf]^2, 1 for perfect ones; 0 where the ellipsoid meets nothing that carries.
// `draw` gets rising numbers in [0, 1).
template <class Draw>
double spread_of_draws(const Scene& scene, const ConnectionEnds& ends, const Draw& draw) {
    constexpr int kDraws = 4'000;
    double sum = 0.0;
    double squares = 0.0;
    for (int k = 0; k < kDraws; ++k) {
        const auto drawn = draw((k + 0.5) / kDraws);
        if (!drawn || is_inside_of_ball(scene, drawn->point.facet, ends)) continue;
        const double estimate =
            carried(ends, scene.facet(drawn->point.facet), drawn->point.position) / drawn->pdf_area;
        sum += estimate;
        squares += estimate * estimate;
    }
    return sum > 0.0 ? kDraws * squares / (sum * sum) : 0.0;
}

// In a gate of 1 cm between points of the room and a light. The median over these ends is 2.1 and a
// tenth lies above 4.6. When the ball's facets shared nodes with walls, and walls were judged by
// the distance to their middle, it was 5.9 and 17.
TEST(ConnectionTechnique, DrawsFollowWhatFacetsCarry) {
    core::Rng rng(test_support::seed_of("DrawsFollowWhat"), 0, 0);
    const Scene scene = room_with_ball();
    const auto technique = technique_of(scene);
    constexpr std::size_t kEnds = 60;
    std::vector<double> spreads;
    while (spreads.size() < kEnds) {
        const auto wall = static_cast<std::uint32_t>(rng.uniform() * 10.0);
        const double u1 = rng.uniform();
        const Vec2 b = core::sample_triangle({u1, rng.uniform()});
        const Vec3 a = scene.facet(wall).point(b.x(), b.y());
        const Vec3 normal = scene.facet(wall).normal.dot(a) < 0.0 ? scene.facet(wall).normal
                                                                  : Vec3(-scene.facet(wall).normal);
        const ConnectionEnds ends{{a, Vec3(0.3, 0.2, 0.6)}, normal, Vec3::Zero()};
        const double length = (ends.foci.a - ends.foci.b).norm() + 0.05 + 0.8 * rng.uniform();
        const OplBand lengths{length, length + 0.01};
        const double spread = spread_of_draws(
            scene, ends, [&](double) { return technique.sample(ends, lengths, rng); });
        if (spread > 0.0) spreads.push_back(spread);
    }
    std::sort(spreads.begin(), spreads.end());
    EXPECT_LT(spreads[kEnds / 2], 3.0);
    EXPECT_LT(spreads[kEnds * 9 / 10], 10.0);
}

// The same from the cuts of third bounces, on a road that begins below the wall, with a ball on it.
// The median is 2.5, a tenth lies above 3.4. When the road was judged at its centroid and scaled to
// the length asked for as if it faced the wall, it was 47 and 578.
TEST(ConnectionTechnique, DrawsOfCutsFollowWhatFacetsCarry) {
    core::Rng rng(test_support::seed_of("DrawsOfCutsFollow"), 0, 0);
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(test_support::parallelogram_object(
        {Vec3(-1, -0.5, 0.05), Vec3(0, 0, 2.15), Vec3(2, 0, 0)}));
    geometry.objects.push_back(test_support::sphere_object(Vec3(-0.4, -0.3, 1.0), 0.2, 3, 1.0));
    geometry.objects.back().name = "ball";
    const Scene scene(
        std::move(geometry), test_support::confocal_scan({Vec3(9, 9, 0)}), renderer::RelayWall{});
    const auto technique = technique_of(scene);
    constexpr std::size_t kEnds = 60;
    std::vector<double> spreads;
    while (spreads.size() < kEnds) {
        const double x = rng.uniform() - 0.5;
        const Vec3 point(x, 0.9 * (rng.uniform() - 0.5), 0.0);
        const ConnectionEnds ends{{point, point}, Vec3::UnitZ(), Vec3::UnitZ()};
        const double length = 1.6 + 0.3 * rng.uniform();
        renderer::HierarchyCut cut(technique.hierarchy());
        cut.rebuild(ends, {length, length + 0.01}, 1000);
        if (cut.empty()) continue;
        std::size_t hint = 0;
        const double spread = spread_of_draws(
            scene, ends, [&](double u) { return technique.sample(cut, u, hint, rng); });
        if (spread > 0.0) spreads.push_back(spread);
    }
    std::sort(spreads.begin(), spreads.end());
    EXPECT_LT(spreads[kEnds / 2], 3.0);
    EXPECT_LT(spreads[kEnds * 9 / 10], 10.0);
}

// E[carried / pdf] over draws against the integral over all facets by stratified points.
TEST(ConnectionTechnique, EstimatesTheIntegralOverAllFacets) {
    core::Rng rng(test_support::seed_of("EstimatesTheIntegral"), 0, 0);
    const Scene scene = random_scene(rng, 60);
    const auto technique = technique_of(scene);
    for (const Question& q : questions(rng)) {
        const auto value = [&](const renderer::SurfacePoint& point) {
            if (is_inside_of_ball(scene, point.facet, q.ends)) return 0.0;
            return carried(q.ends, scene.facet(point.facet), point.position);
        };
        double integral = 0.0;
        constexpr int kSide = 200;
        for (std::uint32_t f = 0; f < scene.facets().size(); ++f) {
            for (int i = 0; i < kSide * kSide; ++i) {
                const Vec2 b = core::sample_triangle(
                    {(i / kSide + rng.uniform()) / kSide, (i % kSide + rng.uniform()) / kSide});
                const Vec3 x = scene.facet(f).point(b.x(), b.y());
                const double length = q.ends.foci.opl_m(x);
                if (length < q.lengths.low_m || length > q.lengths.high_m) continue;
                integral += value({x, f}) * scene.facet(f).area_m2 / (kSide * kSide);
            }
        }
        renderer::HierarchyCut cut(technique.hierarchy());
        cut.rebuild(q.ends, q.lengths, 50);
        constexpr int kDraws = 100'000;
        // Towards the middle of some facet, and not so narrow that few draws see the rest of it.
        const auto aim = static_cast<std::uint32_t>(rng.uniform() * 60);
        const Vec3 middle = scene.facet(aim).point(1.0 / 3.0, 1.0 / 3.0);
        const renderer::LobeOnFacet lobe{
            aim, {(middle - q.ends.foci.a).normalized(), middle, 0.1}, 0.75};
        enum class Kind { Plain, Cut, Lobe };
        for (const Kind kind : {Kind::Plain, Kind::Cut, Kind::Lobe}) {
            double sum = 0.0;
            double squares = 0.0;
            for (int i = 0; i < kDraws; ++i) {
                std::size_t hint = 0;
                std::optional<renderer::ConnectionDraw> draw;
                if (kind == Kind::Plain) draw = technique.sample(q.ends, q.lengths, rng);
                if (kind == Kind::Cut) draw = technique.sample(cut, rng.uniform(), hint, rng);
                if (kind == Kind::Lobe) draw = technique.sample(q.ends, q.lengths, rng, lobe);
                if (!draw) continue;
                if (kind == Kind::Lobe && i % 100 == 0) {
                    const double pdf = technique.pdf_area(q.ends, q.lengths, draw->point, lobe);
                    EXPECT_NEAR(pdf / draw->pdf_area, 1.0, 1e-3);
                }
                const double estimate = value(draw->point) / draw->pdf_area;
                sum += estimate;
                squares += estimate * estimate;
            }
            const double mean = sum / kDraws;
            const double sigma = std::sqrt((squares / kDraws - mean * mean) / kDraws);
            const double tolerance = std::hypot(sigma, 2e-3 * integral);
            EXPECT_GT(test_support::normal_tail((mean - integral) / (tolerance + 1e-300)), 1e-4)
                << "mean " << mean << " integral " << integral << " kind "
                << static_cast<int>(kind);
        }
    }
}

TEST(ConnectionTechnique, LobesOfGlossyVerticesMeetWhatTheyMirror) {
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(
        test_support::parallelogram_object({Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0)}));
    geometry.objects.push_back(
        test_support::parallelogram_object({Vec3(1, -1, 0), Vec3(0, 2, 0), Vec3(0, 0, 2)}));
    const core::WallScan scan = test_support::confocal_scan({Vec3(0, 0, 9)});
    const Scene scene(std::move(geometry), scan, {});
    const auto technique = technique_of(scene);
    renderer::PathVertex vertex;
    vertex.point = {Vec3(0.2, 0.1, 0.0), 0};
    vertex.normal = Vec3::UnitZ();
    vertex.to_previous = Vec3(-1, 0, 1).normalized();
    vertex.bsdf = renderer::GgxConductor{0.9, 0.05};
    const Vec3 light(-0.5, 0.2, 0.7);
    std::uint64_t num_rays = 0;
    const auto lobe = technique.lobe_of(vertex, light, num_rays);
    ASSERT_TRUE(lobe);
    EXPECT_EQ(scene.object_of(lobe->facet).name, scene.objects()[1].name);
    EXPECT_GE(lobe->facet, 2U);
    EXPECT_LT((lobe->lobe.point - Vec3(1.0, 0.1, 0.8)).norm(), 1e-6);
    EXPECT_LT((lobe->lobe.direction - Vec3(1, 0, 1).normalized()).norm(), 1e-12);
    EXPECT_DOUBLE_EQ(lobe->lobe.width_rad, 0.1);
    EXPECT_EQ(num_rays, 1U);

    EXPECT_FALSE(technique.lobe_of(vertex, Vec3(1.5, 0.2, 0.7), num_rays));  // behind that surface
    vertex.to_previous = Vec3(1, 0, 1).normalized();
    EXPECT_FALSE(technique.lobe_of(vertex, light, num_rays));  // into the open
    EXPECT_EQ(num_rays, 3U);
    for (const renderer::Bsdf& wide : {renderer::Bsdf(renderer::GgxConductor{0.9, 0.5}),
                                       renderer::Bsdf(renderer::Lambertian{})}) {
        vertex.bsdf = wide;
        EXPECT_FALSE(technique.lobe_of(vertex, light, num_rays));
    }
    EXPECT_EQ(num_rays, 3U);
}

}  // namespace
