// SPDX-License-Identifier: MIT
// The program's commands as functions from objects to objects.
#include "apps/capture_options.h"
#include "apps/commands/compare_job.h"
#include "apps/commands/describe_file.h"
#include "apps/commands/reconstruct_job.h"
#include "apps/commands/render_job.h"
#include "apps/dataset/generate.h"
#include "apps/python/bindings.h"
#include "apps/report/report.h"
#include "apps/scene_truth.h"
#include "apps/version.h"
#include "nlos/compare/compare.h"
#include "nlos/detector/detector.h"
#include "nlos/detector/sensor_counts.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/capture/recorded_detector.h"
#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/settings/settings_help.h"
#include "renderer/core/settings/settings_json.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace python {
namespace {

namespace nb = nanobind;

// Keywords of render() are keys below `render`, or of scene.json.
core::Json scene_changes(const nb::dict& keywords) {
    const core::Json given = json_from_python(keywords, "");
    const core::Json known = core::write_value(renderer::RenderSettings{});
    core::Json changes = core::Json::object();
    for (const auto& [key, value] : given.items()) {
        if (!known.contains(key)) changes[key] = value;
    }
    for (const auto& [key, value] : given.items()) {
        if (known.contains(key)) changes["render"][key] = value;
    }
    return changes;
}

core::Capture render(const SceneObject& scene,
                     const nb::object& scan,
                     const nb::object& axis,
                     const nb::object& calibration,
                     const nb::dict& settings,
                     const nb::object& progress,
                     int threads) {
    ScannedScene scanned = scan_scene(scene, scan, axis, scene_changes(settings));
    apps::RenderInput input{
        scene.name, std::move(scanned.scene.description), std::move(scanned.scan), nullptr};
    if (!calibration.is_none()) {
        const core::Json json = json_from_python(calibration, "calibration");
        apps::use_calibration(calib::applied_calibration(json, "calibration"), input);
    }
    return run_long(progress, threads, [&](const core::Progress& report) {
        input.scene = std::make_shared<const renderer::Scene>(
            renderer::make_scene(std::move(scanned.scene.geometry), input.description, input.scan));
        return apps::render_input(std::move(input), report).capture;
    });
}

nlos::Reconstruction reconstruct(const core::Capture& capture,
                                 const nb::dict& keywords,
                                 const nb::object& calibration,
                                 const nb::object& progress,
                                 int threads) {
    const auto settings = settings_from_python<nlos::ReconstructSettings>(keywords);
    std::optional<calib::AppliedCalibration> applied;
    if (!calibration.is_none()) {
        applied =
            calib::applied_calibration(json_from_python(calibration, "calibration"), "calibration");
    }
    return run_long(progress, threads, [&](const core::Progress& report) {
        std::optional<core::Capture> calibrated;
        if (applied) {
            core::validate(capture, "capture");
            calibrated = calib::apply_calibration(*applied, capture);
        }
        nlos::Reconstruction result =
            nlos::reconstruct(calibrated ? *calibrated : capture, settings, report);
        result.provenance =
            core::Json{{"program", apps::version_text()}, {"command", "nlos.reconstruct"}};
        for (const std::string& text : result.warnings) report.warn(text);
        return result;
    });
}

core::Capture simulate_noise(const core::Capture& capture,
                             bool of_sensor,
                             const nb::dict& keywords,
                             int threads) {
    std::optional<core::SensorSetup> sensor;
    if (of_sensor) {
        sensor = core::recorded_sensor(capture);
        if (!sensor) {
            throw core::Error("sensor", "the capture gives none", "must be False for other scans");
        }
    }
    auto settings = settings_from_python(
        keywords, sensor ? nlos::detector_of(*sensor) : nlos::DetectorSettings{});
    settings.response = core::resolve_scene_response(settings.response, capture);
    return run_long(nb::none(), threads, [&](const core::Progress& report) {
        core::validate(capture, "capture");
        if (const auto text = nlos::coarse_bins_warning(capture, settings)) report.warn(*text);
        core::Capture noisy = sensor ? nlos::detect_by_sensor(*sensor, capture, settings)
                                     : nlos::detect(capture, settings);
        noisy.scene_info["detector"]["program"] = apps::version_text();
        noisy.scene_info["detector"]["command"] = "nlos.simulate_noise";
        return noisy;
    });
}

nb::object scores(const nlos::Metrics& metrics) {
    const core::Json all = core::write_value(metrics);
    core::Json json = core::Json::object();
    for (const auto& [name, value] : all.items()) {
        if (!value.is_null()) json[name] = value;
    }
    return python_from_json(json);
}

nb::object calibrate(const std::string& path, const nb::dict& changes) {
    const core::Json json = json_from_python(changes, "");
    const core::Json found = run_long(nb::none(), 0, [&](const core::Progress& report) {
        apps::WithCapture<calib::SetupSettings> options{calib::read_setup(path, {}), {}};
        core::read_value(json, "", options);
        const core::Capture capture = with_files_locked(
            [&] { return nlos::read_capture(options.settings.direct_returns, options.capture); });
        const calib::Calibration calibration = calib::calibrate(options.settings, capture);
        for (const std::string& text : calibration.warnings()) report.warn(text);
        return calib::calibration_json(calibration);
    });
    return python_from_json(found);
}

using Pair = std::pair<std::uint64_t, std::uint64_t>;

std::vector<std::string> overrides_of(const nb::dict& keywords) {
    std::vector<std::string> overrides;
    const core::Json json = json_from_python(keywords, "");
    for (const auto& [key, value] : json.items()) overrides.push_back(key + "=" + value.dump());
    return overrides;
}

nb::object generate(const std::string& recipe,
                    const std::string& folder,
                    const std::optional<Pair>& shard,
                    const std::optional<Pair>& items,
                    const nb::dict& keywords,
                    const nb::object& progress,
                    int threads) {
    apps::WorkShare share;
    if (shard) {
        share = apps::read_work_share(std::to_string(shard->first) + "/" +
                                      std::to_string(shard->second));
    }
    std::optional<apps::ItemRange> range;
    if (items) range = apps::ItemRange{items->first, items->second};
    const std::vector<std::string> overrides = overrides_of(keywords);
    const core::Json result = run_long(progress, threads, [&](const core::Progress& report) {
        apps::Dataset dataset(apps::read_recipe(recipe, overrides), folder);
        const apps::GenerateResult made =
            apps::generate(dataset, share, range, apps::version_text(), report);
        for (const auto& [name, reason] : made.broken_meshes) {
            report.warn(name + " was skipped: " + reason);
        }
        return core::Json{{"shards_written", made.shards_written},
                          {"shards_there", made.shards_there},
                          {"items_written", made.items_written},
                          {"dark_items", made.dark_items},
                          {"clipped_counts", made.clipped_counts},
                          {"seconds", made.seconds},
                          {"interrupted", made.interrupted}};
    });
    return python_from_json(result);
}

nb::list help_of(const std::vector<core::SettingHelp>& lines) {
    nb::list list;
    for (const core::SettingHelp& line : lines) {
        list.append(nb::make_tuple(line.key, line.default_value, line.text()));
    }
    return list;
}

nb::list settings_of(const std::string& function) {
    if (function == "render") return help_of(core::settings_help(renderer::SceneDescription{}));
    if (function == "reconstruct") return help_of(core::settings_help(nlos::ReconstructSettings{}));
    if (function == "simulate_noise") return help_of(core::settings_help(nlos::DetectorSettings{}));
    if (function == "fit") return help_of(core::settings_help(calib::FitSettings{}));
    if (function == "read") return help_of(core::settings_help(nlos::CaptureReadSettings{}));
    throw core::Error("function",
                      "found '" + function + "'",
                      "must be one of render, reconstruct, simulate_noise, fit, read");
}

void bind_scores(nb::module_& module) {
    using Threshold = std::optional<double>;
    module.def("compare",
               [](const nlos::Reconstruction& a, const SceneObject& b, const Threshold& threshold) {
                   return scores(run_long(nb::none(), 0, [&](const core::Progress& report) {
                       const core::TrueSurface truth =
                           apps::SceneTruth(b.description, b.geometry).surface(a.volume.axes);
                       if (const auto text = nlos::coarse_truth_warning(truth)) report.warn(*text);
                       return nlos::compare_to_truth(a, truth, threshold);
                   }));
               });
    module.def(
        "compare",
        [](const nlos::Reconstruction& a,
           const nlos::Reconstruction& b,
           const Threshold& threshold) { return scores(nlos::compare_volumes(a, b, threshold)); });
    module.def("compare", [](const core::Capture& a, const core::Capture& b, const Threshold&) {
        return scores(run_long(nb::none(), 0, [&](const core::Progress& report) {
            for (const std::string& text : nlos::comparison_warnings(a, b)) report.warn(text);
            return nlos::compare_captures(a, b);
        }));
    });
    module.def("compare", [](const FitObject& a, const SceneObject& b, const Threshold& threshold) {
        return scores(apps::score_fit(a.result,
                                      calib::compare_fit(a.result, a.result.geometry, b.geometry),
                                      threshold.value_or(apps::kDefaultThreshold_m)));
    });
    module.def(
        "compare", [](const SceneObject& a, const SceneObject& b, const Threshold& threshold) {
            const apps::SceneTruth truth(b.description, b.geometry);
            return scores(nlos::compare_points(apps::surface_samples(a.geometry),
                                               truth.surface().samples,
                                               threshold.value_or(apps::kDefaultThreshold_m)));
        });
    module.def("compare_files",
               [](const std::string& a, const std::string& b, const Threshold& threshold) {
                   return scores(with_files(
                       [&] { return apps::compare_files(a, b, "", threshold).metrics; }));
               });
}

}  // namespace

void bind_work(nb::module_& module) {
    module.def("render",
               &render,
               nb::arg("scene"),
               nb::arg("scan").none(),
               nb::arg("axis").none(),
               nb::arg("calibration").none(),
               nb::arg("settings"),
               nb::arg("progress").none(),
               nb::arg("threads"));
    module.def("reconstruct",
               &reconstruct,
               nb::arg("capture"),
               nb::arg("settings"),
               nb::arg("calibration").none(),
               nb::arg("progress").none(),
               nb::arg("threads"));
    module.def("simulate_noise",
               &simulate_noise,
               nb::arg("capture"),
               nb::arg("sensor"),
               nb::arg("settings"),
               nb::arg("threads"));
    module.def("generate",
               &generate,
               nb::arg("recipe"),
               nb::arg("folder"),
               nb::arg("shard").none(),
               nb::arg("item_range").none(),
               nb::arg("settings"),
               nb::arg("progress").none(),
               nb::arg("threads"));
    module.def("calibrate", &calibrate, nb::arg("setup"), nb::arg("changes"));
    module.def("settings", &settings_of, nb::arg("function"));
    module.def(
        "info",
        [](const std::vector<std::string>& paths, const nb::dict& settings) {
            const auto options = settings_from_python<nlos::CaptureReadSettings>(settings);
            return with_files([&] { return apps::describe_files(paths, options); });
        },
        nb::arg("paths"),
        nb::arg("settings"));
    module.def(
        "report",
        [](const std::string& folder, const std::string& path) {
            with_files([&] { apps::write_report(path, apps::read_results_folder(folder), {}); });
        },
        nb::arg("folder"),
        nb::arg("path"));
    bind_scores(module);
}

}  // namespace python
