// SPDX-License-Identifier: MIT
// The model against the renderer, against exact arcs, and its derivatives against differences.
#include "calib/forward/forward_model.h"

#include "calib/model/state_vector.h"
#include "renderer/render.h"
#include "tests/support/error_message.h"
#include "tests/support/exact_arcs.h"
#include "tests/support/fit_examples.h"
#include "tests/support/surface_models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>

namespace {

using calib::ForwardModel;
using calib::ForwardSettings;
using calib::PairModel;
using calib::SceneModel;
using calib::SceneState;
using core::Vec3;
using renderer::Gradients;

constexpr double kSigma_m = 0.012;

SceneState general_state(const SceneModel& model) {
    SceneState state = model.start();
    state.bodies[0].rotation = Eigen::AngleAxisd(0.2, Vec3(0.0, 0.6, 0.8));
    state.bodies[0].log_size = 0.1;
    state.bodies[1].heights_m = {0.01, -0.02, 0.0, 0.015};
    state.points[0] = {Vec3(0.1, 0.2, 0.5), {{"albedo", -4.0}}};
    for (const auto& [name, number] : calib::Numbers{{"time_zero", 0.003},
                                                     {"ambient", -8.0},
                                                     {"response_fwhm", 0.1},
                                                     {"wall.bow", 0.01},
                                                     {"wall.scale", 0.02},
                                                     {"scale", 0.5}}) {
        state.numbers[name] = number;
    }
    return state;
}

ForwardSettings forward_settings(std::size_t pairs) {
    ForwardSettings settings;
    settings.axis = test_support::kFitAxis;
    settings.sigma_m = kSigma_m;
    settings.response_fraction = 0.7;
    settings.offset_m.assign(pairs, 0.01);
    return settings;
}

double norm(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum);
}

void expect_gradients_match_differences(const core::WallScan& scan, ForwardSettings settings) {
    const SceneModel model(test_support::two_objects(), test_support::all_free());
    const SceneState state = general_state(model);
    ForwardModel light(model, scan, calib::WallMotion(scan), std::move(settings));
    light.refresh(state);
    const auto columns = static_cast<std::size_t>(model.num_columns());
    constexpr double kStep = 1e-6;
    for (const std::size_t pair : {std::size_t{0}, scan.num_pairs() / 2}) {
        PairModel gradients;
        light.update(state, Gradients::With);
        light.evaluate(pair, gradients);
        for (std::size_t c = 0; c < columns; ++c) {
            Eigen::VectorXd step = Eigen::VectorXd::Zero(model.num_columns());
            step[static_cast<Eigen::Index>(c)] = kStep;
            PairModel above;
            PairModel below;
            light.update(calib::moved_by(model, state, step), Gradients::Without);
            light.evaluate(pair, above);
            light.update(calib::moved_by(model, state, -step), Gradients::Without);
            light.evaluate(pair, below);
            std::vector<double> error;
            std::vector<double> size;
            for (std::size_t b = 0; b < above.mean.size(); ++b) {
                const double gradient = (above.mean[b] - below.mean[b]) / (2.0 * kStep);
                error.push_back(gradient - gradients.gradients[b * columns + c]);
                size.push_back(gradient);
            }
            EXPECT_LT(norm(error), 1e-5 * norm(size) + 1e-9) << model.column_names()[c];
        }
    }
}

TEST(ForwardModel, GradientsMatchFiniteDifferencesOnConfocalScans) {
    const core::WallScan scan = test_support::confocal_grid(4);
    expect_gradients_match_differences(scan, forward_settings(scan.num_pairs()));
}

TEST(ForwardModel, GradientsMatchFiniteDifferencesOnExhaustiveScans) {
    const core::WallScan scan = test_support::exhaustive_scan(
        {Vec3(0.1, 0.0, 0.0), Vec3(-0.3, 0.2, 0.0)}, {Vec3(-0.2, -0.1, 0.0), Vec3(0.3, 0.3, 0.0)});
    expect_gradients_match_differences(scan, forward_settings(scan.num_pairs()));
}

TEST(ForwardModel, GradientsMatchFiniteDifferencesThroughAMeasuredResponse) {
    const core::WallScan scan = test_support::single_scan(
        Vec3(0.1, 0.0, 0.0), {Vec3(-0.2, -0.1, 0.0), Vec3(0.3, 0.3, 0.0)});
    ForwardSettings settings = forward_settings(scan.num_pairs());
    settings.measured = core::ExponentialGaussianResponse{0.01, 0.015};
    expect_gradients_match_differences(scan, settings);
}

// One tilted rectangle whose path lengths are all longer by `offset_m`.
struct Rectangle {
    renderer::SceneGeometry geometry;
    core::WallScan scan = test_support::confocal_grid(3);
    ForwardSettings settings = forward_settings(scan.num_pairs());
    std::unique_ptr<SceneModel> model;
    std::unique_ptr<ForwardModel> light;

    explicit Rectangle(double tolerance, double offset_m = 0.0) {
        geometry.objects = {test_support::tilted_rectangle("target", Vec3(0.0, 0.0, 0.8), 0.44)};
        calib::FitSettings free;
        free.free.objects = {{"target", {"translation"}}};
        free.free.parameters.clear();
        model = std::make_unique<SceneModel>(geometry, free);
        settings.response_fraction = 1.0;
        settings.offset_m.assign(scan.num_pairs(), offset_m);
        settings.tolerance = tolerance;
        light = std::make_unique<ForwardModel>(*model, scan, calib::WallMotion(scan), settings);
        light->refresh(model->start());
        light->update(model->start(), Gradients::Without);
    }

    std::vector<double> expected(std::size_t pair) const {
        PairModel result;
        light->evaluate(pair, result);
        return result.mean;
    }

    // By exact arcs, filtered on fine bins.
    std::vector<double> exact(std::size_t pair) const {
        constexpr int kFine = 32;
        core::TimeAxis fine = settings.axis;
        fine.bin_width_m /= kFine;
        fine.num_bins *= kFine;
        std::vector<double> sharp(static_cast<std::size_t>(fine.num_bins));
        const core::TriangleMesh& mesh = geometry.objects[0].mesh;
        for (const auto& [a, b, c] : mesh.triangles) {
            const auto part =
                test_support::confocal_arcs({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                                            scan.sensing.positions[pair],
                                            scan.sensing.normals[pair],
                                            fine);
            for (std::size_t i = 0; i < sharp.size(); ++i) sharp[i] += 0.5 * part[i];  // albedo
        }
        std::vector<double> smooth(sharp.size());
        core::apply_filter<double, double>(
            core::sample_response(core::GaussianResponse{kSigma_m}, fine.bin_width_m),
            sharp,
            smooth);
        std::vector<double> result(static_cast<std::size_t>(settings.axis.num_bins));
        for (std::size_t i = 0; i < smooth.size(); ++i) result[i / kFine] += smooth[i];
        return result;
    }
};

double sum(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(ForwardModel, AgreesWithExactArcsInShapeAndEnergy) {
    for (const auto& [tolerance, most_shape, most_energy] :
         {std::array{2e-2, 1.5e-2, 1e-4}, std::array{1e-3, 1.5e-3, 1e-5}}) {
        const Rectangle rectangle(tolerance);
        for (std::size_t pair = 0; pair < rectangle.scan.num_pairs(); ++pair) {
            const std::vector<double> exact = rectangle.exact(pair);
            std::vector<double> difference = rectangle.expected(pair);
            for (std::size_t b = 0; b < exact.size(); ++b) difference[b] -= exact[b];
            EXPECT_LT(norm(difference), most_shape * norm(exact));
            EXPECT_LT(std::abs(sum(difference)), most_energy * sum(exact));
        }
    }
}

TEST(ForwardModel, KeepsItsEnergyWhenLightMovesByPartsOfABin) {
    const Rectangle still(5e-3);
    for (const double part : {0.13, 0.5, 0.77}) {
        const Rectangle moved(5e-3, part * still.settings.axis.bin_width_m);
        for (std::size_t pair = 0; pair < still.scan.num_pairs(); ++pair) {
            EXPECT_NEAR(sum(moved.expected(pair)) / sum(still.expected(pair)), 1.0, 1e-10);
        }
    }
}

// Relative L2 over a confocal scan.
double difference_from_renderer(const renderer::SceneGeometry& geometry, double spot_m2) {
    calib::FitSettings free;
    free.free.objects = {{"front", {"translation"}}};
    free.free.parameters.clear();
    const SceneModel model(geometry, free);
    const core::WallScan scan = test_support::confocal_grid(8);
    ForwardSettings settings = forward_settings(scan.num_pairs());
    settings.sigma_m = 0.0;
    settings.offset_m.assign(scan.num_pairs(), 0.0);
    settings.tolerance = 5e-3;
    settings.radiance_factor = std::pow(core::kPi, -3.0);
    settings.spot_m2 = spot_m2;
    ForwardModel light(model, scan, calib::WallMotion(scan), settings);
    light.refresh(model.start());
    light.update(model.start(), Gradients::Without);

    const renderer::Scene scene(geometry, scan, renderer::RelayWall{});
    renderer::RenderSettings render_settings;
    render_settings.target_error = 3e-3;
    render_settings.laser_spot_m2 = spot_m2;
    const auto rendered =
        renderer::render(scene, scan, settings.axis, render_settings, {}).capture.transient;
    double difference = 0.0;
    double size = 0.0;
    PairModel expected;
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        light.evaluate(pair, expected);
        for (std::size_t b = 0; b < expected.mean.size(); ++b) {
            const double reference = static_cast<double>(rendered.histogram(pair)[b]);
            difference += std::pow(expected.mean[b] - reference, 2.0);
            size += reference * reference;
        }
    }
    return std::sqrt(difference / size);
}

// Shadow edges are known to quarters of elements.
TEST(ForwardModel, AgreesWithTheRendererBehindAnOccluder) {
    EXPECT_LT(difference_from_renderer(test_support::two_objects(), 1e-4), 0.03);
}

TEST(ForwardModel, AgreesWithTheRendererOrRefusesForEverySurfaceModel) {
    for (const double albedo : {0.5, 0.0}) {
        for (const renderer::Material& material :
             test_support::materials_of_all_models(albedo, 0.5)) {
            SCOPED_TRACE(material.name);
            renderer::SceneGeometry geometry = test_support::two_objects();
            geometry.objects.front().material = material;
            if (renderer::traits_of(material.model).can_be_fitted()) {
                EXPECT_LT(difference_from_renderer(geometry, 3e-4), 0.03);
                continue;
            }
            const std::string message = test_support::error_message(
                [&] { static_cast<void>(difference_from_renderer(geometry, 3e-4)); });
            EXPECT_NE(message.find("object front: is a " + material.name), std::string::npos)
                << message;
        }
    }
}

}  // namespace
