// SPDX-License-Identifier: MIT
// Meshes whose vertices are free along their normals.
#include "calib/fit/fit_objective.h"
#include "renderer/core/random.h"
#include "tests/support/fit_examples.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::Vec3;

constexpr int kSide = 4;  // vertices

// The tilted rectangle as a mesh of side x side vertices.
renderer::SceneGeometry grid(int side = kSide) {
    renderer::Object object =
        test_support::tilted_rectangle("target", Vec3(0.05, -0.02, 0.8), 0.35);
    const auto corners = object.mesh;
    const Vec3 origin = corners.vertices[0];
    const Vec3 u = corners.vertices[1] - origin;
    const Vec3 v = corners.vertices[3] - origin;
    object.mesh.vertices.clear();
    object.mesh.triangles.clear();
    const auto row = static_cast<std::uint32_t>(side);
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
            object.mesh.vertices.push_back(origin + i / (side - 1.0) * u + j / (side - 1.0) * v);
            if (i + 1 == side || j + 1 == side) continue;
            const std::uint32_t first =
                static_cast<std::uint32_t>(j) * row + static_cast<std::uint32_t>(i);
            object.mesh.triangles.push_back({first, first + 1, first + row + 1});
            object.mesh.triangles.push_back({first, first + row + 1, first + row});
        }
    }
    renderer::SceneGeometry geometry;
    geometry.objects = {object};
    return geometry;
}

std::vector<double> true_heights() {
    std::vector<double> heights;
    for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide; ++i) {
            const double x = 2.0 * i / (kSide - 1.0) - 1.0;
            const double y = 2.0 * j / (kSide - 1.0) - 1.0;
            heights.push_back(0.015 * std::cos(1.4 * x) * std::cos(1.1 * y) + 0.006 * x * y);
        }
    }
    return heights;
}

calib::FitInput heights_input(const core::Capture& capture) {
    calib::FitInput input = test_support::fit_input(capture, grid());
    input.settings.free.objects = {{"target", {"albedo", "vertices"}}};
    return input;
}

// Errors over what the fit reports: mean square about 1, 48 values spread by 0.2.
TEST(Heights, AreFoundWithinTheirReportedErrors) {
    const renderer::SceneGeometry flat = grid();
    renderer::SceneGeometry raised = flat;
    renderer::Object& object = raised.objects.front();
    const Vec3 normal = object.world_from_node.linear().col(2);
    const std::vector<double> truth = true_heights();
    for (std::size_t v = 0; v < truth.size(); ++v) object.mesh.vertices[v] += truth[v] * normal;
    const core::Capture light =
        test_support::expected_capture(raised, test_support::confocal_grid(8), 3e5, 0.02);
    double squares = 0.0;
    int count = 0;
    for (const char* seed : {"Heights 1", "Heights 2", "Heights 3"}) {
        const calib::FitResult fit =
            calib::fit_scene(heights_input(test_support::counted(light, seed)), {});
        EXPECT_TRUE(fit.converged) << fit.message;
        const calib::FittedObject& found = fit.objects.front();
        ASSERT_EQ(found.heights_m.size(), truth.size());
        for (std::size_t v = 0; v < truth.size(); ++v) {
            const double error = found.heights_m[v] - truth[v];
            EXPECT_LT(std::abs(error), 4e-3) << v;
            EXPECT_LT(found.heights_sigma_m[v], 2e-3) << v;
            squares += std::pow(error / found.heights_sigma_m[v], 2);
            ++count;
        }
    }
    EXPECT_GT(squares / count, 0.3);
    EXPECT_LT(squares / count, 1.9);
}

// One wall point cannot tell 81 heights apart: its rows are rank-deficient, and what is dropped for
// that must be rounding. Cost and gradient against those without compression, by differences.
TEST(Heights, RankDeficientRowsKeepCostAndGradient) {
    const renderer::SceneGeometry geometry = grid(9);
    const core::WallScan scan = test_support::confocal_grid(4);
    const core::Capture counts = test_support::counted(
        test_support::expected_capture(geometry, scan, 1e5, 0.02), "RankDeficient");
    calib::FitSettings settings;
    settings.free.objects = {{"target", {"pose", "albedo", "vertices"}}};
    const calib::SceneModel model(geometry, settings);
    calib::ForwardSettings forward;
    forward.axis = test_support::kFitAxis;
    forward.sigma_m = core::sigma_m_from_fwhm_ps(test_support::kFitFwhm_ps);
    forward.offset_m.assign(scan.num_pairs(), 0.0);
    forward.radiance_factor = 1e5;
    forward.tolerance = 2e-3;
    calib::ForwardModel light(model, scan, calib::WallMotion(scan), forward);
    calib::SceneState state = model.start();
    core::Rng rng(test_support::seed_of("RankDeficientRows"), 0, 0);
    for (double& height : state.bodies.front().heights_m) height = 0.01 * rng.uniform();
    light.refresh(state);

    calib::FitData data;
    data.axis = counts.time_axis;
    data.values.assign(counts.transient.values().begin(), counts.transient.values().end());
    data.min_mean = 1e-6;
    calib::FitObjective objective(light, data, true, {}, model.num_columns());
    objective.evaluate(state, renderer::Gradients::Without);
    const double cost = objective.sum_of_squares();
    objective.evaluate(state, renderer::Gradients::With);
    EXPECT_NEAR(objective.sum_of_squares() / cost, 1.0, 1e-9);

    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(model.num_columns());
    for (std::size_t pair = 0; pair < objective.num_pairs(); ++pair) {
        const auto& rows = objective.pair(pair);
        gradient += 2.0 * rows.jacobian.transpose() * rows.residual;
    }
    const auto blocks = model.find(calib::Owner::Body, 0, calib::Effect::Deforms);
    ASSERT_EQ(blocks.size(), 1U);
    for (const int vertex : {0, 40, 77}) {
        constexpr double kStep_m = 1e-6;
        double& height = state.bodies.front().heights_m[static_cast<std::size_t>(vertex)];
        double ends[2];
        for (const int end : {0, 1}) {
            height += end == 0 ? -kStep_m : 2.0 * kStep_m;
            objective.evaluate(state, renderer::Gradients::Without);
            ends[end] = objective.sum_of_squares();
        }
        height -= kStep_m;
        const double expected = (ends[1] - ends[0]) / (2.0 * kStep_m);
        EXPECT_NEAR(gradient[blocks[0]->first_column + vertex], expected, 1e-4 * std::abs(expected))
            << vertex;
    }
}

}  // namespace
