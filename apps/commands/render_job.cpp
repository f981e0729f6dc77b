// SPDX-License-Identifier: MIT
#include "apps/commands/render_job.h"

#include "apps/arguments.h"
#include "apps/file_kind.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "nlos/formats/capture_file.h"
#include "nlos/pictures/pictures.h"
#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/file_suffix.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
#include "renderer/frame_sequence.h"
#include "renderer/light_range.h"
#include "renderer/render.h"
#include "renderer/scene/scene_file.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace apps {
namespace {

// How reuse went: merges, shifts and why shifts were rejected, over all frames.
core::Json resampling_of(const renderer::RenderResult& result) {
    const renderer::RestirCounts& counts = result.restir_counts;
    core::Json info;
    info["merges"] = counts.num_merges;
    info["shifts_tried"] = counts.shifts.tried();
    info["shifts_accepted"] = counts.shifts.accepted;
    info["shifts_accepted_by_ray"] = counts.shifts.by_ray;
    for (std::size_t i = 0; i < counts.shifts.rejected.size(); ++i) {
        info["shifts_rejected"][std::string(renderer::kShiftRejectionNames[i])] =
            counts.shifts.rejected[i];
    }
    return info;
}

core::Json sources_of(const renderer::RenderResult& result) {
    core::Json orders;
    for (const renderer::OrderSource& source : result.sources) {
        orders.push_back({{"first", source.first_order},
                          {"last", source.last_order},
                          {"estimator", std::string(core::enum_name(source.estimator))},
                          {"surfaces", source.surfaces}});
    }
    return orders;
}

bool excludes_surfaces(const renderer::RenderResult& result) {
    return std::ranges::any_of(result.sources, [](const renderer::OrderSource& source) {
        return renderer::traits_of(source.estimator).excludes_surfaces;
    });
}

core::Json provenance(const RenderInput& input, const renderer::RenderResult& result) {
    core::Json info;
    info["program"] = version_text();
    info["command"] = command_line();
    info["scene"] = core::printable(input.scene_name);
    info["estimator"] = estimator_names(result);
    if (!result.sources.empty()) info["orders"] = sources_of(result);
    if (result.estimated_error) info["estimated_error"] = *result.estimated_error;
    if (result.left_out) info[core::kLeftOutOrdersKey] = core::write_value(*result.left_out);
    if (result.smoothing) {
        info["smoothing"] = {{"points", result.smoothing->points},
                             {"bins", result.smoothing->bins}};
    }
    if (excludes_surfaces(result)) {
        const std::string_view mode = core::enum_name(input.description.render.exclude);
        info["excluded"] = {{"mode", std::string(mode)},
                            {"objects", result.excluded.names},
                            {"connected", result.excluded.connected}};
    }
    info["samples_per_pair"] = result.samples_per_pair;
    if (result.restir_counts.num_merges > 0) info["restir"] = resampling_of(result);
    info["seconds"] = result.seconds;
    info["interrupted"] = result.interrupted;
    info["settings"] = core::write_value(input.description);
    if (const auto sensor = core::recorded_sensor(result.capture)) {
        info["sensor"] = core::write_value(*sensor);
    }
    return info;
}

renderer::RenderResult run(const std::shared_ptr<const renderer::Scene>& scene,
                           const renderer::SceneDescription& description,
                           const core::Scan& scan,
                           const core::Progress& progress) {
    if (description.frames) {
        return renderer::render_frames(scene,
                                       scan,
                                       description,
                                       renderer::make_frame_renderer(scan, description.render),
                                       progress);
    }
    return renderer::render(*scene,
                            scan,
                            {description.time_axis, description.velocity_axis},
                            description.render,
                            progress);
}

// What a device with these offsets records of light on an axis between wall points.
core::TimeAxis axis_of_device(const calib::AppliedCalibration& calibration, core::TimeAxis axis) {
    const auto [least, most] =
        std::minmax_element(calibration.opl_offset_m.begin(), calibration.opl_offset_m.end());
    axis.opl_start_m += *least;
    axis.num_bins += static_cast<int>(std::ceil((*most - *least) / axis.bin_width_m));
    return axis;
}

// Darkness has no error that could be given relative to it.
void report_darkness(renderer::RenderResult& result, const core::Progress& progress) {
    if (const auto& sequence = result.capture.sequence) {
        const auto dark = std::ranges::count_if(sequence->frames, &core::Transient::is_dark);
        if (dark > 0) {
            progress.warn(
                fmt::format("{} of {} frames hold no light", dark, sequence->frames.size()));
        }
    } else if (result.capture.transient.is_dark()) {
        progress.warn("the capture holds no light: all its values are 0");
    }
    if (result.capture.transient.is_dark()) result.estimated_error.reset();
}

// Passes warnings on, each once, and keeps them.
core::Progress recording(const core::Progress& progress, std::vector<std::string>& warnings) {
    core::Progress recorded = progress;
    recorded.warn = [&warnings, warn = progress.warn](const std::string& text) {
        if (std::ranges::find(warnings, text) != warnings.end()) return;
        warnings.push_back(text);
        if (warn) warn(text);
    };
    return recorded;
}

std::string light_text(const renderer::LightRange& light, const core::TimeAxis& axis) {
    return fmt::format(
        "paths of {:.4g} to {:.4g} m are possible; the time axis, {:.4g} to {:.4g} m, holds "
        "{:.3g} % of the light",
        light.possible_m[0],
        light.possible_m[1],
        axis.opl_start_m,
        axis.opl_end_m(),
        100.0 * light.fraction_between(axis.opl_start_m, axis.opl_end_m()));
}

core::Json write_light(const renderer::LightRange& light, const core::TimeAxis& axis) {
    return {{"possible_m", light.possible_m},
            {"found_m", light.without_tails(0.0)},
            {"share_in_axis", light.fraction_between(axis.opl_start_m, axis.opl_end_m())}};
}

void choose_axis(const std::optional<renderer::LightRange>& light, RenderInput& input) {
    renderer::SceneDescription& description = input.description;
    if (input.calibration && !description.detector) {
        description.detector = {input.calibration->response.jitter_fwhm_ps};
    }
    const core::TimeAxis axis =
        renderer::choose_time_axis(light, *input.scene, input.scan, description);
    description.time_axis = {input.calibration ? axis_of_device(*input.calibration, axis) : axis};
    renderer::validate(description, input.scene_name + ": ");
}

// With the axis between wall points of what a calibrated device records.
renderer::SceneDescription description_between_points(const RenderInput& input) {
    renderer::SceneDescription between = input.description;
    if (input.calibration) {
        between.time_axis = {calib::axis_to_render(*input.calibration, between.time_axis)};
    }
    return between;
}

void tell_of_light(const renderer::LightRange& light,
                   const renderer::SceneDescription& rendered,
                   const core::Progress& progress) {
    if (!light.is_dark() && progress.announce) {
        progress.announce(light_text(light, rendered.time_axis));
    }
    for (const auto& text : renderer::axis_warnings(light, rendered.time_axis, rendered.frames)) {
        progress.warn(text);
    }
}

/// A mesh is no scene: it does not say where wall and scan are.
void refuse_mesh(const std::string& path) {
    if (core::file_suffix(path) == ".json" || !std::filesystem::exists(path)) return;
    const FileKind kind = kind_of_file(path);
    core::require(
        kind != FileKind::Geometry && kind != FileKind::PointCloud,
        path,
        "a mesh",
        fmt::format("a scene (.json), which says where wall and scan are: `nlos scene {} -o "
                    "scene.json` proposes one",
                    core::printable(path)));
}

}  // namespace

std::string estimator_names(const renderer::RenderResult& result) {
    std::vector<std::string_view> names;
    for (const renderer::OrderSource& source : result.sources) {
        const std::string_view name = core::enum_name(source.estimator);
        if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
    return names.empty() ? "closed form" : fmt::format("{}", fmt::join(names, " + "));
}

void use_calibration(calib::AppliedCalibration calibration, RenderInput& input) {
    const auto* points = input.scan.as<core::WallScan>();
    if (points == nullptr || input.scan.as<core::SensorScan>() != nullptr ||
        input.description.frames || input.description.velocity_axis) {
        throw core::Error("calibration",
                          "found a camera, a sensor, frames or a velocity axis",
                          "must be a scan without these");
    }
    calib::replace_points(calibration, input.scan.wall());
    input.calibration = std::move(calibration);
}

renderer::RenderResult render_input(RenderInput input, const core::Progress& caller) {
    std::vector<std::string> warnings;
    const core::Progress progress = recording(caller, warnings);
    progress.stage(1, 3, "where the light lies", 0.0, 0.0);
    for (const std::string& text : input.scene->warnings()) progress.warn(text);
    const std::string coincident = renderer::describe(input.scene->coincident_faces());
    if (!coincident.empty() && progress.announce) progress.announce(coincident);
    const auto light =
        renderer::find_light_range(*input.scene, input.scan, input.description.render);
    if (input.description.time_axis.automatic) choose_axis(light, input);
    const renderer::SceneDescription rendered = description_between_points(input);
    if (light) tell_of_light(*light, rendered, progress);

    renderer::RenderResult result =
        run(input.scene, rendered, input.scan, progress.stage(2, 3, "rendering", 0.0, 1.0));
    if (input.calibration) {
        result.capture =
            calib::record_with(*input.calibration, result.capture, input.description.time_axis);
    }
    report_darkness(result, progress);
    core::Json info = provenance(input, result);
    if (!coincident.empty()) info["coincident_faces"] = coincident;
    if (light) info["light"] = write_light(*light, rendered.time_axis);
    if (!warnings.empty()) info["warnings"] = warnings;
    result.capture.scene_info = std::move(info);
    return result;
}

renderer::RenderResult render_to_file(const std::string& scene_path,
                                      const std::vector<std::string>& overrides,
                                      const std::string& capture_path,
                                      const std::string& calibration_path) {
    nlos::check_capture_suffix(capture_path);
    core::check_targets({capture_path}, {scene_path, calibration_path});
    refuse_mesh(scene_path);
    ProgressBar bar("render");
    RenderInput input;
    input.scene_name = std::filesystem::absolute(scene_path).lexically_normal().string();
    input.description = renderer::read_scene_description(scene_path, overrides);
    input.scan = renderer::make_scan(input.description);
    if (!calibration_path.empty())
        use_calibration(calib::read_calibration(calibration_path), input);
    input.scene = std::make_shared<const renderer::Scene>(
        renderer::load_scene(input.description, input.scan));

    const StoppableWork stoppable(
        "stopping after this pass, to write what was computed; Ctrl-C again ends at once, without "
        "a file");
    const core::Progress progress = bar.progress();
    renderer::RenderResult result = render_input(std::move(input), progress);
    progress.stage(3, 3, "writing", 1.0, 1.0);
    for (const std::string& left_out : nlos::write_capture(capture_path, result.capture)) {
        progress.warn(left_out);
    }
    if (const auto* image = result.capture.scan.as<core::ImageScan>()) {
        core::write_text_file(with_suffix(capture_path, ".png"),
                              nlos::encode_preview_png(result.capture, image->camera));
    }
    return result;
}

}  // namespace apps
