// SPDX-License-Identifier: MIT
#include "apps/fit_job.h"

#include "apps/arguments.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "calib/calibrate.h"
#include "calib/fit_file.h"
#include "calib/poisson_deviance.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "renderer/core/output_file.h"
#include "renderer/gltf.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;

// Rows of a picture; more wall points are averaged in groups.
constexpr std::size_t kMostRows = 256;

calib::FitInput make_input(const std::string& capture_path,
                           const std::string& model_path,
                           const std::vector<std::string>& overrides) {
    calib::FitInput input;
    input.settings = calib::read_fit_settings(model_path, overrides);
    input.capture = nlos::read_capture(capture_path);
    input.scene = renderer::read_scene_description(input.settings.scene, {});
    input.geometry = renderer::load_gltf(input.scene.geometry);
    if (input.settings.start != "given" && input.settings.start != "search") {
        input.start_points = nlos::read_volume(input.settings.start).points.positions;
    }
    return input;
}

// The data stay as they are: offsets go into the model, where they cost no light.
void use_calibration(const calib::AppliedCalibration& calibration, calib::FitInput& input) {
    calib::replace_points(calibration, input.capture.scan);
    input.offset_m = calib::pair_offsets(calibration, input.capture.scan);
    const core::ResponseSettings& response = input.settings.response;
    if (response.jitter_fwhm_ps == 0.0 && response.tail_ps == 0.0 && response.curve.empty()) {
        input.settings.response = calibration.response;
    }
}

void write_results(const calib::FitInput& input,
                   const calib::FitResult& result,
                   const std::string& fit_path) {
    const std::string stem = fs::path(fit_path).replace_extension().string();
    renderer::write_gltf(stem + ".glb", result.geometry);
    const std::string geometry = fs::path(stem + ".glb").filename().string();
    core::write_text_file(stem + ".scene.json",
                          calib::fitted_scene_json(input, geometry).dump(2) + "\n");
    nlos::write_panels_png(stem + ".png", fit_panels(result), 3);
    core::Json json = calib::fit_json(result);
    json["program"] = version_text();
    json["command"] = command_line();
    json["settings"] = core::write_value(input.settings);
    core::write_text_file(fit_path, json.dump(2) + "\n");
}

nlos::ImagePanel rows_panel(const calib::FitResult& result, const std::string& title) {
    nlos::ImagePanel panel;
    panel.title = title;
    panel.width = static_cast<std::size_t>(result.axis.num_bins);
    panel.x_range = {result.axis.opl_start_m, result.axis.opl_end_m()};
    panel.x_label = "path length [m]";
    panel.y_label = "pair";
    panel.scale = nlos::AxisScale::Free;
    return panel;
}

}  // namespace

std::vector<nlos::Panel> fit_panels(const calib::FitResult& result) {
    const auto bins = static_cast<std::size_t>(result.axis.num_bins);
    const std::size_t pairs = result.data.size() / bins;
    const std::size_t group = (pairs + kMostRows - 1) / kMostRows;
    const std::size_t rows = (pairs + group - 1) / group;
    nlos::ImagePanel data = rows_panel(result, "Data");
    nlos::ImagePanel model = rows_panel(result, "Model");
    nlos::ImagePanel residual = rows_panel(result, "Data - model");
    const bool is_poisson = result.residual == "poisson";
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t bin = 0; bin < bins; ++bin) {
            double counted = 0.0;
            double expected = 0.0;
            for (std::size_t i = row * group; i < std::min(pairs, (row + 1) * group); ++i) {
                counted += result.data[i * bins + bin];
                expected += result.model[i * bins + bin];
            }
            data.values.push_back(static_cast<float>(counted));
            model.values.push_back(static_cast<float>(expected));
            const double misfit = is_poisson && expected > 0.0
                                      ? -calib::signed_deviance(expected, counted).value
                                      : counted - expected;
            residual.values.push_back(static_cast<float>(misfit));
        }
    }
    const float most = *std::max_element(data.values.begin(), data.values.end());
    double widest = 0.0;
    for (const float value : residual.values) {
        widest = std::max(widest, std::abs(static_cast<double>(value)));
    }
    for (nlos::ImagePanel* panel : {&data, &model, &residual}) {
        panel->height = rows;
        panel->y_range = {0.0, static_cast<double>(pairs)};
    }
    data.value_range = model.value_range = std::array{0.0, static_cast<double>(most)};
    data.value_label = model.value_label = is_poisson ? "counts" : "value";
    residual.value_label = is_poisson ? "standard deviations" : "value";
    residual.colour_map = nlos::ColourMap::Diverging;
    residual.value_range = std::array{-widest, widest};
    return {data, model, residual};
}

calib::FitResult fit_to_file(const std::string& capture_path,
                             const std::string& model_path,
                             const std::vector<std::string>& overrides,
                             const std::string& calibration,
                             const std::string& fit_path) {
    // A target that cannot be written is found before the work, not after it.
    const core::OutputFile probe(fit_path);
    calib::FitInput input = make_input(capture_path, model_path, overrides);
    if (!calibration.empty()) use_calibration(calib::read_calibration(calibration), input);
    ProgressBar bar("fit");
    calib::FitResult result = calib::fit_scene(input, bar.progress());
    write_results(input, result, fit_path);
    return result;
}

}  // namespace apps
