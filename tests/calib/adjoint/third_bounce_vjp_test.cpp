// SPDX-License-Identifier: MIT
// Third bounces of meshes against the renderer, and what the pullback takes and refuses.
#include "calib/third_bounce_vjp.h"

#include "renderer/core/system/parallel.h"
#include "renderer/render.h"
#include "tests/support/error_message.h"
#include "tests/support/gradient_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using calib::MeshGradients;
using calib::ThirdBounceVjp;
using core::Vec3;
using test_support::GradientCase;

TEST(ThirdBounceVjp, HistogramsAgreeWithTheRenderer) {
    constexpr double kWallAlbedo = 0.7;
    for (std::uint64_t number = 0; number < 4; ++number) {
        GradientCase example(number);
        example.settings = {.tolerance = 5e-3, .wall_albedo = kWallAlbedo};
        renderer::RelayWall wall;
        wall.albedo = kWallAlbedo;
        wall.center_m = Vec3(1e6, 1e6, 1e6);  // hides nothing, as points of curved walls need
        const renderer::Scene scene(test_support::geometry_of(example.shapes), example.scan, wall);
        renderer::RenderSettings settings;
        settings.method = renderer::Estimator::ThirdBounce;
        settings.target_error = 5e-3;
        const auto rendered =
            renderer::render(scene, example.scan, test_support::kGradientAxis, settings, {});
        const auto values = rendered.capture.transient.values();
        const std::vector<double> expected(values.begin(), values.end());
        const auto histograms = example.vjp(example.shapes).histograms();
        const std::span<const double> a = histograms;
        const std::span<const double> b = expected;
        EXPECT_LT(test_support::relative_l2(a, b), 4e-3) << "case " << number;
        EXPECT_NEAR(test_support::sum_of(a) / test_support::sum_of(b), 1.0, 1e-3);
    }
}

TEST(ThirdBounceVjp, OneAndSevenThreadsGiveTheSameBytes) {
    core::Rng rng(test_support::seed_of("threads"), 0, 0);
    GradientCase example(0);
    example.scan = test_support::confocal_scan(test_support::random_wall_points(70, rng).positions);
    example.weights = test_support::random_weights(
        70 * static_cast<std::size_t>(test_support::kGradientAxis.num_bins), rng);
    const auto compute = [&](int threads) {
        const core::ThreadLimit limit(threads);
        return std::pair(example.vjp(example.shapes).histograms(), example.gradients());
    };
    const auto one = compute(1);
    const auto seven = compute(7);
    EXPECT_EQ(one.first, seven.first);
    EXPECT_EQ(one.second.vertices, seven.second.vertices);
    EXPECT_EQ(one.second.albedo, seven.second.albedo);
}

// Coordinates there are rounded by 1e-10 m.
TEST(ThirdBounceVjp, IsTheSameAThousandKilometresAway) {
    for (std::uint64_t number = 0; number < 4; ++number) {
        const GradientCase here(number);
        GradientCase there = here;
        const Vec3 way(4e5, -1e6, 7e5);
        for (Vec3& vertex : there.shapes.mesh.vertices) vertex += way;
        there.scan = core::moved(core::Scan(here.scan), way).wall();
        const auto expected_light = here.vjp(here.shapes).histograms();
        const auto light = there.vjp(there.shapes).histograms();
        EXPECT_LT(test_support::relative_l2(std::span<const double>(light), expected_light), 1e-6);
        const MeshGradients expected = here.gradients();
        const MeshGradients gradients = there.gradients();
        double difference = 0.0;
        double all = 0.0;
        for (std::size_t v = 0; v < expected.vertices.size(); ++v) {
            difference += (gradients.vertices[v] - expected.vertices[v]).squaredNorm();
            all += expected.vertices[v].squaredNorm();
        }
        EXPECT_LT(std::sqrt(difference / all), 1e-5) << "case " << number;
    }
}

TEST(ThirdBounceVjp, FacetsWithoutAreaCountForNothing) {
    const GradientCase example(1);
    GradientCase more = example;
    auto& mesh = more.shapes.mesh;
    mesh.triangles.push_back({3, 3, 8});
    const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(0.5 * (mesh.vertices[0] + mesh.vertices[4]));
    mesh.triangles.push_back({0, 4, n});
    more.shapes.albedo.insert(more.shapes.albedo.end(), {0.5, 0.5});
    const auto expected_light = example.vjp(example.shapes).histograms();
    const auto light = more.vjp(more.shapes).histograms();
    EXPECT_LT(test_support::relative_l2(std::span<const double>(light), expected_light), 1e-12);
    const MeshGradients expected = example.gradients();
    const MeshGradients gradients = more.gradients();
    for (std::size_t v = 0; v < n; ++v) {
        EXPECT_LT((gradients.vertices[v] - expected.vertices[v]).norm(),
                  1e-12 * expected.vertices[v].norm());
    }
    EXPECT_EQ(gradients.vertices[n], Vec3(Vec3::Zero()));
    EXPECT_EQ(gradients.albedo.back(), 0.0);
}

Vec3 on_plane(double x, double y) {
    return {x, y, 0.65 + 0.125 * x + 0.125 * y};
}

/// A square panel of two facets.
GradientCase panel_case() {
    GradientCase panel(1);
    panel.settings.tolerance = 2e-3;
    panel.shapes.mesh = {};
    panel.shapes.mesh.vertices = {
        on_plane(-0.2, -0.2), on_plane(0.2, -0.2), on_plane(0.2, 0.2), on_plane(-0.2, 0.2)};
    panel.shapes.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    panel.shapes.albedo = {0.5, 0.8};
    return panel;
}

TEST(ThirdBounceVjp, FacetsOnOthersCountForNothing) {
    const GradientCase once = panel_case();
    GradientCase doubled = once;
    doubled.shapes.mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}, {1, 2, 3}};
    doubled.shapes.albedo = {0.5, 0.8, 0.9, 0.9};
    EXPECT_EQ(doubled.vjp(doubled.shapes).histograms(), once.vjp(once.shapes).histograms());
    const MeshGradients expected = once.gradients();
    const MeshGradients gradients = doubled.gradients();
    EXPECT_EQ(gradients.vertices, expected.vertices);
    EXPECT_EQ(gradients.albedo,
              (std::vector<double>{expected.albedo[0], expected.albedo[1], 0.0, 0.0}));
}

TEST(ThirdBounceVjp, OfAFacetThatLiesOnOthersInPartTheRestCounts) {
    GradientCase over = panel_case();
    auto& vertices = over.shapes.mesh.vertices;
    vertices.insert(vertices.end(), {on_plane(0.0, 0.0), on_plane(0.4, 0.0), on_plane(0.4, 0.2)});
    over.shapes.mesh.triangles.push_back({4, 5, 6});
    over.shapes.albedo.push_back(0.6);

    GradientCase beside = panel_case();
    auto& corners = beside.shapes.mesh.vertices;
    corners.insert(
        corners.end(),
        {on_plane(0.2, 0.0), on_plane(0.4, 0.0), on_plane(0.4, 0.2), on_plane(0.2, 0.1)});
    beside.shapes.mesh.triangles.insert(beside.shapes.mesh.triangles.end(), {{4, 5, 6}, {4, 6, 7}});
    beside.shapes.albedo.insert(beside.shapes.albedo.end(), {0.6, 0.6});
    const auto expected_light = beside.vjp(beside.shapes).histograms();
    const auto light = over.vjp(over.shapes).histograms();
    EXPECT_LT(test_support::relative_l2(std::span<const double>(light), expected_light), 1e-3);

    // As all of it moves, the part that counts stays the same.
    const std::vector<Vec3> motion(vertices.size(), Vec3(0.3, -0.2, 1.0));
    const MeshGradients gradients = over.gradients();
    double slope = 0.0;
    for (std::size_t i = 0; i < motion.size(); ++i) slope += gradients.vertices[i].dot(motion[i]);
    EXPECT_NEAR(slope, over.difference(motion, 1e-7), 1e-4 * std::abs(slope));
    const MeshGradients expected = beside.gradients();
    EXPECT_NEAR(gradients.albedo[2],
                expected.albedo[2] + expected.albedo[3],
                1e-2 * std::abs(gradients.albedo[2]));
}

TEST(ThirdBounceVjp, AMeshWithoutFacetsIsDark) {
    const GradientCase example(0);
    const ThirdBounceVjp vjp = example.vjp({});
    EXPECT_EQ(vjp.histograms(), std::vector<double>(example.weights.size(), 0.0));
    EXPECT_TRUE(vjp.pullback(example.weights).vertices.empty());
}

TEST(ThirdBounceVjp, WrongInputIsNamed) {
    const GradientCase example(0);
    const auto with = [&](const auto& change) {
        GradientCase wrong = example;
        change(wrong);
        return wrong.vjp(wrong.shapes).histograms().size();
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_ERROR_WITH(with([&](GradientCase& c) { c.shapes.mesh.vertices[3].y() = nan; }),
                      "found vertex 3 that is not finite");
    EXPECT_ERROR_WITH(with([](GradientCase& c) { c.shapes.mesh.triangles[2][1] = 99; }),
                      "found vertex 99 in triangle 2; must be below the number of vertices, 22");
    EXPECT_ERROR_WITH(with([](GradientCase& c) { c.shapes.albedo.pop_back(); }),
                      "albedo: found 14 values; must be one for each of 15 triangles");
    EXPECT_ERROR_WITH(with([](GradientCase& c) { c.shapes.albedo[1] = -0.1; }), "albedo");
    EXPECT_ERROR_WITH(with([&](GradientCase& c) { c.shapes.albedo[1] = nan; }), "albedo");
    EXPECT_ERROR_WITH(with([](GradientCase& c) { c.settings.tolerance = 0.0; }), "tolerance");
    EXPECT_ERROR_WITH(with([](GradientCase& c) { c.scan.sensing.normals.pop_back(); }), "normals");
    const ThirdBounceVjp vjp = example.vjp(example.shapes);
    EXPECT_ERROR_WITH(vjp.pullback(std::vector<double>(7)), "found 7 values; must be 4 pairs");
    std::vector<double> weights = example.weights;
    weights[5] = nan;
    EXPECT_ERROR_WITH(vjp.pullback(weights), "gradients by the histograms");
}

TEST(ThirdBounceVjp, AWallPointMayLieOnTheMesh) {
    GradientCase example(0);
    example.shapes.mesh.vertices[4] = example.scan.sensing.positions[2];
    const ThirdBounceVjp vjp = example.vjp(example.shapes);
    for (const double value : vjp.histograms()) EXPECT_TRUE(std::isfinite(value));
    const MeshGradients gradients = vjp.pullback(example.weights);
    for (const Vec3& gradient : gradients.vertices) EXPECT_TRUE(gradient.allFinite());
}

TEST(ThirdBounceVjp, StopsWhenAsked) {
    const GradientCase example(0);
    core::Progress progress;
    progress.stop_requested = [] { return true; };
    EXPECT_THROW(example.vjp(example.shapes).pullback(example.weights, progress), core::Failure);
}

}  // namespace
