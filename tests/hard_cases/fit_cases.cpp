// SPDX-License-Identifier: MIT
// Ill-posed fits. Grazing tilts, nearly symmetric objects, few photons, hidden and missing objects:
// tests/calib/hard_fits_test.cpp; set-ups that the data cannot determine: calibrate_test.cpp.
#include "calib/forward/forward_model.h"
#include "calib/setup/direct_returns.h"
#include "calib/statistics/uncertainty.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/random.h"
#include "tests/hard_cases/autodiff_reference.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/extended_precision.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/fit_examples.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace hard_cases {
using core::Vec3;
using truth::Quad;

double errors_of_nearly_collinear_parameters() {
    core::Rng rng(test_support::seed_of("errors_of_nearly_collinear_parameters"), 0, 0);
    Worst worst;
    for (int i = 0; i < 2000; ++i) {
        // Two parameters in units 1e-8 to 1e8 that the data tell apart by 1 - correlation^2 down to
        // 1e-8: sigma_1^2 = I_22/det.
        const double a = std::pow(10.0, 16.0 * rng.uniform() - 8.0);
        const double b = std::pow(10.0, 16.0 * rng.uniform() - 8.0);
        const double apart = std::pow(10.0, -8.0 * rng.uniform());
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        Eigen::MatrixXd information(2, 2);
        information << a * a, sign * (1.0 - apart) * a * b, sign * (1.0 - apart) * a * b, b * b;
        const calib::Uncertainty found = calib::assess(information, {"a", "b"});
        const Quad i00 = information(0, 0);
        const Quad i11 = information(1, 1);
        const Quad i01 = information(0, 1);
        const Quad determinant = i00 * i11 - i01 * i01;
        worst.add(truth::relative_error(found.sigma[0], truth::sqrtq(i11 / determinant)));
        worst.add(truth::relative_error(found.sigma[1], truth::sqrtq(i00 / determinant)));
        // What cannot be told apart is said.
        const bool is_open = apart < 0.0099;
        if (is_open) worst.add(found.unidentifiable.empty() ? HUGE_VAL : 0.0);
    }
    return worst.value();
}

double direct_returns_of_few_and_of_many_counts() {
    // Expected counts instead of drawn ones: the fit must then find the truth, far below a bin,
    // whatever the counts, beside one another.
    constexpr double kSigma = 0.012;
    const std::vector<double> counts{30.0, 1e3, 1e6, 1e9};
    core::Capture capture;
    capture.scan = test_support::confocal_scan(std::vector<Vec3>(counts.size(), Vec3::Zero()));
    capture.time_axis = {1.0, 0.008, 128};
    capture.unit = core::TransientUnit::Counts;
    capture.transient = core::Transient(counts.size(), 128);
    const auto length = [](std::size_t i) { return 1.4 + 0.00237 * static_cast<double>(i); };
    for (std::size_t i = 0; i < counts.size(); ++i) {
        for (int bin = 0; bin < 128; ++bin) {
            const auto below = [&](int k) {
                return core::gaussian_cdf(capture.time_axis.bin_begin_m(k) - length(i), kSigma);
            };
            capture.transient.histogram(i)[static_cast<std::size_t>(bin)] =
                static_cast<float>(0.01 + counts[i] * (below(bin + 1) - below(bin)));
        }
    }
    const calib::DirectReturns found =
        calib::fit_direct_returns(capture, calib::ResponseShape::Gaussian);
    Worst worst;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        worst.add(std::abs(found.points[i].opl_m - length(i)) / 0.008);
    }
    worst.add(std::abs(found.sigma_m / kSigma - 1.0));
    return worst.value();
}

double gradients_of_the_light_of_tiny_and_large_objects() {
    // Written by hand, against automatic derivatives of another program text; relative L2 over all
    // bins, for each of the pose's six parameters.
    const core::WallScan scan = test_support::confocal_grid(2);
    calib::FitSettings settings;
    settings.free.parameters.clear();
    settings.free.objects = {{"target", {"pose"}}};
    Worst worst;
    for (const double size : {1e-6, 1e-3, 0.1, 2.0}) {
        renderer::Object object = test_support::parallelogram_object(
            {Vec3(0.05, -0.02, 0.8), size * Vec3(1, 0.2, 0.3), size * Vec3(-0.1, 1, 0.2), 1.0});
        object.name = "target";
        object.world_from_node.translation() = object.mesh.vertices[0];
        renderer::SceneGeometry geometry;
        geometry.objects = {object};
        const calib::SceneModel model(geometry, settings);
        calib::ForwardSettings forward;
        forward.axis = {0.9, 0.0192, 400};
        forward.sigma_m = 0.012;
        forward.offset_m.assign(scan.num_pairs(), 0.0);
        calib::ForwardModel light(model, scan, calib::WallMotion(scan), forward);
        const calib::SceneState state = model.start();
        light.refresh(state);
        light.update(state, renderer::Gradients::With);
        const auto columns = static_cast<std::size_t>(model.num_columns());
        for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
            calib::PairModel found;
            light.evaluate(pair, found);
            const std::vector<double> jets = autodiff_jacobian(model, state, light, pair);
            for (std::size_t c = 0; c < 6; ++c) {
                double square = 0.0;
                double error = 0.0;
                for (std::size_t bin = 0; bin < 400; ++bin) {
                    const double gradient = jets[bin * 6 + c];
                    square += gradient * gradient;
                    error += std::pow(found.gradients[bin * columns + c] - gradient, 2);
                }
                worst.add(std::sqrt(error / square));
            }
        }
    }
    return worst.value();
}

}  // namespace hard_cases
