// SPDX-License-Identifier: MIT
// First vertices drawn in batches against the same draws one by one.
#include "renderer/path/first_vertex_batch.h"

#include "renderer/core/sampling.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
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
        core::Rng rng(test_support::seed_of("FirstVertexDraws"), 0, 0);
        FirstVertexBatch vertices(scene_, traits_);
        int drawn = 0;
        core::Rng again = rng;
        FirstVertexBatch::AreaDraws draws(count, rng);
        Vec2 shift;
        shift.x() = again.uniform();
        shift.y() = again.uniform();
        for (; !draws.done(); vertices.clear()) {
            vertices.draw_by_area(sampler, draws);
            for (int i = 0; i < vertices.size(); ++i, ++drawn) {
                const Vec2 u = core::lattice_point(drawn, count, shift);
                const auto expected = sampler.sample(u.x(), u.y());
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
    FirstVertexBatch::AreaDraws by_area(500, rng);
    int met = 0;
    int hidden = 0;
    int drawn_by_area = 0;
    for (; !by_area.done() || !directions.done(); vertices.clear()) {
        const int begin = by_area.begin;
        vertices.draw(directions, sampler, by_area);
        drawn_by_area += by_area.begin - begin;
        met += vertices.size() - (by_area.begin - begin);
        vertices.evaluate(ends, {1.0, 0.5, sampler.pdf_area()});
        for (int i = 0; i < vertices.size(); i += 3) vertices.set_contribution(i, 0.0);
        vertices.keep_useful();
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

// Vertices of a batch that an end sees at very different distances.
FirstVertexBatch evaluated_batch(const renderer::Scene& scene,
                                 const renderer::FacetTraits& traits,
                                 core::Rng& rng) {
    renderer::PathEndpoints ends;
    ends.sensor.position = Vec3(0.1, -0.2, 0.3);
    ends.light = ends.sensor;
    ends.coincide = true;
    const renderer::AreaSampler sampler(scene);
    FirstVertexBatch vertices(scene, traits);
    FirstVertexBatch::AreaDraws draws(100, rng);
    vertices.draw_by_area(sampler, draws);
    vertices.evaluate(ends, {1.0, 1.0, sampler.pdf_area()});
    return vertices;
}

void expect_fraction(double found, double probability, int num_draws) {
    const double sigma = std::sqrt(probability * (1.0 - probability) / num_draws);
    EXPECT_LT(std::abs(found / num_draws - probability), 5.0 * sigma + 1e-12);
}

// The mean of what is left after thinning is what was there.
TEST_F(FirstVertexDraws, ThinningKeepsTheMeanOfEveryContribution) {
    constexpr int kDraws = 20'000;
    core::Rng rng(test_support::seed_of("FirstVertexDraws.thin"), 0, 0);
    const FirstVertexBatch all = evaluated_batch(scene_, traits_, rng);
    const auto before = all.contributions();
    const double step = 3.0 * test_support::sum_of(before) / all.size();
    std::vector<double> times(before.size());
    for (int draw = 0; draw < kDraws; ++draw) {
        FirstVertexBatch thinned = all;
        thinned.thin(3.0, rng);
        std::size_t i = 0;
        for (int kept = 0; kept < thinned.size(); ++kept, ++i) {
            while (all.opl_m()[i] != thinned.opl_m()[static_cast<std::size_t>(kept)]) ++i;
            EXPECT_EQ(thinned.contributions()[static_cast<std::size_t>(kept)],
                      std::max(step, before[i]));
            times[i] += 1.0;
        }
    }
    int large = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
        expect_fraction(times[i], std::min(1.0, before[i] / step), kDraws);
        large += before[i] >= step ? 1 : 0;
    }
    EXPECT_GT(large, 0);
}

TEST_F(FirstVertexDraws, ByThroughputAreWeighedByTheirProbability) {
    constexpr int kDraws = 20'000;
    core::Rng rng(test_support::seed_of("FirstVertexDraws.throughput"), 0, 0);
    const FirstVertexBatch all = evaluated_batch(scene_, traits_, rng);
    std::vector<double> times(static_cast<std::size_t>(all.size()));
    std::vector<double> scales(times.size(), 1.0);
    for (int draw = 0; draw < kDraws; ++draw) {
        for (const auto& [index, scale] : all.draw_by_throughput(5.0, rng)) {
            times[static_cast<std::size_t>(index)] += 1.0;
            scales[static_cast<std::size_t>(index)] = scale;
        }
    }
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (times[i] > 0.0) expect_fraction(times[i], 1.0 / scales[i], kDraws);
    }
    const auto carrying = all.draw_by_throughput(1.0, rng);
    for (const auto& drawn : carrying) EXPECT_EQ(drawn.scale, 1.0);
    EXPECT_EQ(static_cast<std::ptrdiff_t>(carrying.size()),
              std::ranges::count_if(times, [](double t) { return t > 0.0; }))
        << "every vertex that carries light is drawn at some time";
}

TEST_F(FirstVertexDraws, OtherLengthsAreLeftOut) {
    core::Rng rng(test_support::seed_of("FirstVertexDraws.lengths"), 0, 0);
    FirstVertexBatch vertices = evaluated_batch(scene_, traits_, rng);
    const std::vector<double> before(vertices.contributions().begin(),
                                     vertices.contributions().end());
    const double fraction = vertices.leave_out_other_lengths({0.3, 0.3});
    double inside = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        const bool counts = vertices.opl_m()[i] >= 0.3 && vertices.opl_m()[i] < 0.6;
        EXPECT_EQ(vertices.contributions()[i], counts ? before[i] : 0.0);
        if (counts) inside += before[i];
    }
    EXPECT_GT(inside, 0.0);
    EXPECT_NEAR(fraction, inside / test_support::sum_of(before), 1e-12);
    EXPECT_EQ(vertices.leave_out_other_lengths({7.0, 1.0}), 0.0);
}

}  // namespace
