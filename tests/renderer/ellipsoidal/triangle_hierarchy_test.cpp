// SPDX-License-Identifier: MIT
// The hierarchy's draws against their probabilities, and its bounds.
#include "renderer/ellipsoidal/triangle_hierarchy.h"

#include "renderer/core/sampling.h"
#include "renderer/ellipsoidal/hierarchy_cut.h"
#include "tests/renderer/ellipsoidal/connection_scenes.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

namespace {

using connection_test::carried;
using connection_test::is_inside_of_ball;
using connection_test::Question;
using connection_test::questions;
using connection_test::random_scene;
using connection_test::technique_of;
using core::Vec2;
using core::Vec3;
using renderer::Scene;

// Chi-square of drawn facets, and of draws that find none, against the probabilities.
template <class Sample, class Probability>
double facet_p_value(const Scene& scene, const Sample& sample, const Probability& probability) {
    constexpr int kDraws = 20'000;
    const std::size_t num_facets = scene.facets().size();
    std::vector<double> observed(num_facets + 1);
    std::vector<double> expected(num_facets + 1);
    for (int i = 0; i < kDraws; ++i) {
        const auto choice = sample((i + 0.5) / kDraws);
        ++observed[choice ? choice->facet : num_facets];
    }
    double sum = 0.0;
    for (std::uint32_t f = 0; f < num_facets; ++f) {
        const double p = probability(f);
        expected[f] = kDraws * p;
        sum += p;
    }
    EXPECT_LT(sum, 1.0 + 1e-9);
    expected[num_facets] = kDraws * std::max(0.0, 1.0 - sum);
    return test_support::chi_square_p_value(observed, expected);
}

TEST(TriangleHierarchy, DrawsMatchTheirProbabilities) {
    core::Rng rng(test_support::seed_of("DrawsMatchTheirProbabilities"), 0, 0);
    const Scene scene = random_scene(rng, 500);
    const auto technique = technique_of(scene);
    const auto& hierarchy = technique.hierarchy();
    for (const Question& q : questions(rng)) {
        const double p = facet_p_value(
            scene,
            [&](double) { return hierarchy.sample(q.ends, q.lengths, rng.uniform()); },
            [&](std::uint32_t f) { return hierarchy.evaluate(q.ends, q.lengths, f).probability; });
        EXPECT_GT(p, 1e-4);
        for (const std::size_t entries : {1, 20, 100'000}) {
            renderer::HierarchyCut cut(hierarchy);
            cut.rebuild(q.ends, q.lengths, entries);
            std::size_t hint = 0;
            const double p_cut = facet_p_value(
                scene,
                [&](double u) { return cut.sample(u, hint); },
                [&](std::uint32_t f) { return cut.evaluate(f).probability; });
            EXPECT_GT(p_cut, 1e-4) << entries;
        }
    }
}

TEST(TriangleHierarchy, EveryPointThatCarriesSomethingCanBeDrawn) {
    core::Rng rng(test_support::seed_of("EveryPointThatCarries"), 0, 0);
    const Scene scene = random_scene(rng, 500);
    const auto technique = technique_of(scene);
    int checked = 0;
    for (const Question& q : questions(rng)) {
        renderer::HierarchyCut cut(technique.hierarchy());
        cut.rebuild(q.ends, q.lengths, 1000);
        for (std::uint32_t f = 0; f < scene.facets().size(); ++f) {
            if (is_inside_of_ball(scene, f, q.ends)) continue;
            for (int i = 0; i < 50; ++i) {
                const double u1 = rng.uniform();
                const Vec2 b = core::sample_triangle({u1, rng.uniform()});
                const Vec3 x = scene.facet(f).point(b.x(), b.y());
                const double length = q.ends.foci.opl_m(x);
                if (length < q.lengths.low_m || length > q.lengths.high_m) continue;
                if (!(carried(q.ends, scene.facet(f), x) > 0.0)) continue;
                ++checked;
                EXPECT_GT(technique.pdf_area(q.ends, q.lengths, {x, f}), 0.0);
                EXPECT_GT(technique.pdf_area(cut, {x, f}), 0.0);
            }
        }
    }
    EXPECT_GT(checked, 10'000);
}

}  // namespace
