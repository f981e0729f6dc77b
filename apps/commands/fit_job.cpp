// SPDX-License-Identifier: MIT
#include "apps/commands/fit_job.h"

#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/commands/fit_pictures.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "calib/fit_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/preparation/capture_faults.h"
#include "nlos/preparation/checks/capture_check.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
#include "renderer/gltf/gltf.h"
#include "renderer/scene/load_geometry.h"

#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;

constexpr int kFitColumns = 3;  // of the picture

void refuse_camera(const calib::FitInput& input) {
    if (input.capture.scan.has_wall() && !input.scene.camera) return;
    throw core::Error(input.scene.camera ? input.settings.scene : "capture",
                      "has a camera in place of a relay wall",
                      "must be a scan of a relay wall");
}

calib::FitInput make_input(const FitRequest& request) {
    calib::FitInput input;
    std::vector<std::string> overrides = request.overrides;
    const CaptureOptions options = capture_options(take_capture_overrides(overrides));
    input.settings = calib::read_fit_settings(request.model, overrides);
    input.capture = nlos::read_capture(request.capture, options.capture);
    input.scene = renderer::read_scene_description(input.settings.scene, {});
    input.geometry = renderer::load_geometry(input.scene);
    if (input.settings.start != "given" && input.settings.start != "search") {
        if (!fs::exists(input.settings.start)) {
            throw core::Error(request.model + ": start",
                              "found '" + input.settings.start + "', which does not exist",
                              "must be given, search or a VOLUME.h5");
        }
        input.start_points = nlos::read_volume(input.settings.start).points.positions;
    }
    return input;
}

}  // namespace

// The data stay as they are: offsets go into the model, where they cost no light.
void use_calibration(const calib::AppliedCalibration& calibration, calib::FitInput& input) {
    calib::replace_points(calibration, input.capture.scan.wall());
    input.offset_m = calib::pair_offsets(calibration, input.capture.scan.wall());
    if (!core::is_given(input.settings.response)) input.settings.response = calibration.response;
}

calib::FitResult fit_input(const calib::FitInput& input, const core::Progress& progress) {
    refuse_camera(input);
    const nlos::CaptureFaults faults = nlos::find_faults(input.capture);
    calib::FitInput mended;
    if (!faults.empty()) {
        mended = input;
        mended.capture = nlos::leave_out(faults, input.capture);
    }
    calib::FitResult result = calib::fit_scene(faults.empty() ? input : mended, progress);
    for (std::string& text : nlos::capture_warnings(input.capture)) {
        result.warnings.push_back(std::move(text));
    }
    return result;
}

void write_fit(const calib::FitInput& input,
               const calib::FitResult& result,
               const std::string& fit_path) {
    const std::string stem = fs::path(fit_path).replace_extension().string();
    renderer::write_gltf(stem + ".glb", result.geometry);
    const std::string geometry = fs::path(stem + ".glb").filename().string();
    core::write_text_file(stem + ".scene.json",
                          core::json_text(calib::fitted_scene_json(input, geometry)));
    nlos::write_panels(stem + ".png", fit_panels(result), kFitColumns);
    core::Json json = calib::fit_json(result);
    json["program"] = version_text();
    json["command"] = command_line();
    json["settings"] = core::write_value(input.settings);
    core::write_text_file(fit_path, core::json_text(json));
}

calib::FitResult fit_to_file(const FitRequest& request) {
    require_suffix(request.fit, {".json"});
    nlos::check_picture_suffix(request.picture);
    calib::FitInput input = make_input(request);
    std::vector<std::string> sources{request.capture,
                                     request.model,
                                     request.calibration,
                                     input.settings.scene,
                                     input.settings.start};
    for (const auto& path : renderer::geometry_files(input.scene)) sources.push_back(path);
    core::check_targets({request.fit,
                         with_suffix(request.fit, ".scene.json"),
                         with_suffix(request.fit, ".glb"),
                         with_suffix(request.fit, ".png"),
                         request.picture},
                        sources);
    if (!request.calibration.empty()) {
        use_calibration(calib::read_calibration(request.calibration), input);
    }
    ProgressBar bar("fit");
    const core::Progress progress = bar.progress();
    const calib::FitResult result = [&] {
        const StoppableWork stoppable(
            "stopping after this step, without a file; Ctrl-C again ends at once");
        return fit_input(input, progress);
    }();
    if (progress.should_stop()) throw core::Failure("fit", "interrupted");
    write_fit(input, result, request.fit);
    if (!request.picture.empty()) {
        nlos::write_panels(request.picture, fit_panels(result), kFitColumns);
    }
    return result;
}

}  // namespace apps
