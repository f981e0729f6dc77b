// SPDX-License-Identifier: MIT
#include "apps/commands/fit_job.h"
#include "apps/commands/fit_pictures.h"
#include "apps/python/bindings.h"
#include "calib/fit_file.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/scene/load_geometry.h"

#include <fmt/core.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>

namespace python {
namespace {

namespace nb = nanobind;

/// What a fit needs of a capture; the histograms stay where they are.
core::Capture borrowed(core::Capture& capture) {
    core::Capture view;
    view.scan = capture.scan.wall();
    view.time_axis = capture.time_axis;
    view.transient = core::Transient(capture.transient.num_pairs(),
                                     capture.transient.values(),
                                     std::shared_ptr<void>(&capture, [](void*) {}));
    view.observed = capture.observed;
    view.unit = capture.unit;
    view.counts_per_radiance = capture.counts_per_radiance;
    view.scene_info = capture.scene_info;
    return view;
}

calib::FitInput make_input(core::Capture& capture,
                           const SceneObject& scene,
                           const nb::dict& settings) {
    calib::FitInput input;
    input.settings.scene = scene.name;
    core::read_value(json_from_python(settings, ""), "", input.settings);
    calib::validate(input.settings, "");
    input.capture = borrowed(capture);
    input.scene = scene.description;
    input.geometry = scene.geometry;
    return input;
}

FitObject fit(core::Capture& capture,
              const SceneObject& scene,
              const nb::dict& settings,
              const nb::object& calibration,
              nb::handle start_points,
              const nb::object& progress,
              int threads) {
    core::validate(capture, "capture");
    FitObject fitted;
    fitted.input = make_input(capture, scene, settings);
    fitted.input.start_points = vectors_from(start_points, "start");
    if (!calibration.is_none()) {
        const core::Json json = json_from_python(calibration, "calibration");
        apps::use_calibration(calib::applied_calibration(json, "calibration"), fitted.input);
    }
    fitted.result = run_long(progress, threads, [&](const core::Progress& report) {
        return apps::fit_input(fitted.input, report);
    });
    fitted.input.capture.transient = {};  // it is the caller's
    return fitted;
}

template <auto Values>
Array<double> histograms(nb::handle self) {
    auto& result = nb::cast<FitObject&>(self).result;
    auto& numbers = result.*Values;
    const auto bins = static_cast<std::size_t>(result.axis.num_bins);
    return array_view(numbers.data(), {numbers.size() / bins, bins}, self);
}

SceneObject scene_of(const FitObject& fitted) {
    SceneObject scene;
    scene.name = "fit";
    scene.description = fitted.input.scene;
    scene.description.objects.clear();  // the geometry holds what they said
    scene.geometry = fitted.result.geometry;
    return scene;
}

std::vector<nlos::Panel> panels_of(const FitObject& fitted) {
    return apps::fit_panels(fitted.result);
}

std::string fitted_text(const FitObject& fitted) {
    const calib::FitResult& result = fitted.result;
    return fmt::format("Fit{}: {} objects, deviance {:.4g} of {:.4g} expected, {} iterations",
                       result.converged ? "" : " that did not converge",
                       result.objects.size(),
                       result.deviance,
                       result.expected_deviance,
                       result.iterations);
}

Array<double> covariance_of(const FitObject& fitted) {
    const Eigen::MatrixXd& matrix = fitted.result.covariance;
    return array_of(
        std::vector<double>(matrix.data(), matrix.data() + matrix.size()),
        {static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols())});
}

}  // namespace

void bind_fit(nb::module_& module) {
    nb::class_<FitObject> binding(module, "FitResult", "What fit() found, with its uncertainty.");
    binding
        .def_prop_ro(
            "values",
            [](const FitObject& f) { return python_from_json(calib::fit_json(f.result)); },
            "all fitted quantities and, under `sigma`, their standard deviations, as FIT.json")
        .def_prop_ro("scene", &scene_of, "Scene with the fitted objects")
        .def_prop_ro("converged", [](const FitObject& f) { return f.result.converged; })
        .def_prop_ro("message", [](const FitObject& f) { return f.result.message; })
        .def_prop_ro("deviance", [](const FitObject& f) { return f.result.deviance; })
        .def_prop_ro("expected_deviance",
                     [](const FitObject& f) { return f.result.expected_deviance; })
        .def_prop_ro("parameters", [](const FitObject& f) { return f.result.parameters; })
        .def_prop_ro(
            "covariance", &covariance_of, nb::rv_policy::reference, "(P, P) of `parameters`")
        .def_prop_ro("unidentifiable", [](const FitObject& f) { return f.result.unidentifiable; })
        .def_prop_ro("warnings", [](const FitObject& f) { return f.result.warnings; })
        .def_prop_ro("seconds", [](const FitObject& f) { return f.result.seconds; })
        .def_prop_ro("data",
                     &histograms<&calib::FitAgreement::data>,
                     "(pairs, bins) float64, as the fit used them")
        .def_prop_ro("model",
                     &histograms<&calib::FitAgreement::model>,
                     "(pairs, bins) float64, what the fitted scene explains")
        .def(
            "write",
            [](const FitObject& f, nb::handle target) {
                const std::string path = path_from(target);
                with_files([&] { apps::write_fit(f.input, f.result, path); });
            },
            nb::arg("path").none(),
            "Writes FIT.json and, beside it, the fitted scene and a picture.")
        .def("__repr__", &fitted_text);
    bind_pictures(binding, &panels_of, 3, "PNG, SVG or PDF: data, model and their difference.");
    module.def("fit",
               &fit,
               nb::arg("capture"),
               nb::arg("scene"),
               nb::arg("settings"),
               nb::arg("calibration").none(),
               nb::arg("start_points"),
               nb::arg("progress").none(),
               nb::arg("threads"));
}

}  // namespace python
