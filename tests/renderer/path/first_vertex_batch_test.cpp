// SPDX-License-Identifier: MIT
// First vertices drawn in batches against the same draws one by one.
#include "renderer/path/first_vertex_batch.h"

#include "renderer/core/sampling.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::Vec2;
using core::Vec3;
using renderer::DirectionPacket;
using renderer::FirstVertexBatch;

class FirstVertexDraws : public testing::Test {
 protected:
    FirstVertexDraws()
        : scene_({{test_support::sphere_object(Vec3(0.1, -0.2, 0.7), 0.3, 2, 0.8)}, {}},
                 test_support::confocal_scan({Vec3(0.0, 0.0, 0.0)}),
                 {}),
          traits_(scene_, std::vector<bool>(scene_.objects().size(), true)) {}

    renderer::Scene scene_;
    renderer::FacetTraits traits_;
};

TEST_F(FirstVertexDraws, ByAreaAreThoseOfTheSampler) {
    const renderer::AreaSampler sampler(scene_);
    for (const int count : {1, 7, 128, 129, 300, 5'000}) {
        const core::Rng rng(test_support::seed_of("FirstVertexDraws"), 0, 0);
        core::Rng batches = rng;
        core::Rng singles = rng;
        FirstVertexBatch vertices(scene_, traits_);
        int drawn = 0;
        for (FirstVertexBatch::AreaDraws draws{count}; !draws.done(); vertices.clear()) {
            vertices.draw_by_area(sampler, draws, batches);
            std::vector<double> u1(static_cast<std::size_t>(vertices.size()));
            std::vector<double> u2(u1.size());
            singles.fill_uniform(u1);
            singles.fill_uniform(u2);
            for (int i = 0; i < vertices.size(); ++i, ++drawn) {
                const auto lane = static_cast<std::size_t>(i);
                const auto expected = sampler.sample((drawn + u1[lane]) / count, u2[lane]);
                EXPECT_EQ(vertices.facet(i), expected.facet);
                EXPECT_LT((vertices.point(i).position - expected.position).norm(), 1e-12);
            }
        }
        EXPECT_EQ(drawn, count);
    }
}

// The warps are tested against their densities; lattice points are uniform.
TEST_F(FirstVertexDraws, DirectionsAreWarpsOfTheLattice) {
    renderer::PathEndpoint end;
    end.normal = Vec3(0.3, -0.5, 0.8).normalized();
    const core::Mat3 world = core::frame_from_normal(end.normal, scene_.tangent_hint(end.normal));
    for (const bool isotropic : {false, true}) {
        end.isotropic = isotropic;
        for (const int count : {1, 15, 16, 17, 300}) {
            core::Rng rng(test_support::seed_of("EndpointDirectionSampler"), 0, 0);
            core::Rng again = rng;
            renderer::EndpointDirectionSampler directions(scene_, end, count, rng);
            Vec2 shift;
            shift.x() = again.uniform();
            shift.y() = again.uniform();
            int drawn = 0;
            for (DirectionPacket packet; !directions.done();) {
                directions.next(packet);
                for (std::size_t i = 0; i < static_cast<std::size_t>(packet.count); ++i) {
                    const Vec2 u = core::lattice_point(drawn++, count, shift);
                    const Vec3 expected = world * (isotropic ? core::sample_sphere(u)
                                                             : core::sample_cosine_hemisphere(u));
                    const Vec3 direction(packet.x[i], packet.y[i], packet.z[i]);
                    EXPECT_LT((direction - expected).norm(), 1e-11) << drawn << " of " << count;
                }
            }
            EXPECT_EQ(drawn, count);
        }
    }
}

// Also when the arrays fill up before the directions are done.
TEST_F(FirstVertexDraws, ByDirectionLieWhereSingleRaysEnd) {
    renderer::PathEndpoint end;
    end.position = Vec3(0.1, -0.2, 0.7);  // inside the sphere: every ray meets it
    end.isotropic = true;
    core::Rng rng(test_support::seed_of("FirstVertexDraws.direction"), 0, 0);
    FirstVertexBatch vertices(scene_, traits_);
    renderer::EndpointDirectionSampler directions(scene_, end, 500, rng);
    int drawn = 0;
    std::uint64_t num_rays = 0;
    for (; !directions.done(); vertices.clear()) {
        num_rays += vertices.draw_by_direction(directions);
        for (int i = 0; i < vertices.size(); ++i, ++drawn) {
            const Vec3 direction = (vertices.point(i).position - end.position).normalized();
            const auto hit = scene_.first_hit(end.position, end.normal, direction);
            ASSERT_TRUE(hit);
            EXPECT_LT((hit->position - vertices.point(i).position).norm(), 1e-6);
        }
    }
    EXPECT_EQ(drawn, 500);
    EXPECT_EQ(num_rays, 500U);
}

// What directions met is in sight and takes no further ray, wherever it stands after others were
// dropped; of the points by area only those in sight carry something.
TEST_F(FirstVertexDraws, BothKindsTogetherAreSeenAsSingleRaysSee) {
    renderer::PathEndpoints ends;
    ends.sensor.position = Vec3(0.1, -0.2, 0.0);
    ends.light = ends.sensor;
    ends.coincide = true;
    const renderer::AreaSampler sampler(scene_);
    core::Rng rng(test_support::seed_of("FirstVertexDraws.both"), 0, 0);
    FirstVertexBatch vertices(scene_, traits_);
    renderer::EndpointDirectionSampler directions(scene_, ends.sensor, 300, rng);
    FirstVertexBatch::AreaDraws by_area{500};
    int met = 0;
    int hidden = 0;
    int drawn_by_area = 0;
    for (; !by_area.done() || !directions.done(); vertices.clear()) {
        const int begin = by_area.begin;
        vertices.draw(directions, sampler, by_area, rng);
        drawn_by_area += by_area.begin - begin;
        met += vertices.size() - (by_area.begin - begin);
        vertices.evaluate(ends, {1.0, 0.5, sampler.pdf_area()});
        for (int i = 0; i < vertices.size(); i += 3) vertices.set_contribution(i, 0.0);
        vertices.keep_useful(true);
        const auto num_rays = static_cast<int>(vertices.trace_from_sensor(ends));
        EXPECT_LE(num_rays, by_area.begin - begin);
        for (int i = 0; i < vertices.size(); ++i) {
            const auto point = vertices.point(i);
            const bool blocked = scene_.rays().is_blocked(ends.sensor.position,
                                                          ends.sensor.normal,
                                                          point.position,
                                                          scene_.facet(point.facet).normal);
            EXPECT_EQ(vertices.contributions()[static_cast<std::size_t>(i)] == 0.0, blocked);
            hidden += blocked;
        }
        const int all = vertices.size();
        const auto visible =
            std::ranges::count_if(vertices.contributions(), [](double c) { return c > 0.0; });
        vertices.keep_seen();
        EXPECT_EQ(vertices.size(), visible) << "of " << all;
    }
    EXPECT_EQ(drawn_by_area, 500);
    EXPECT_GT(met, 10);
    EXPECT_GT(hidden, 100);
}

}  // namespace
