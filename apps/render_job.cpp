// SPDX-License-Identifier: MIT
#include "apps/render_job.h"

#include "apps/arguments.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/output_file.h"
#include "renderer/render.h"

#include <filesystem>

namespace apps {
namespace {

core::Json provenance(const std::string& scene_path,
                      const renderer::SceneDescription& description,
                      const renderer::RenderResult& result) {
    core::Json info;
    info["program"] = version_text();
    info["command"] = command_line();
    info["scene"] = std::filesystem::absolute(scene_path).lexically_normal().string();
    info["estimator"] = std::string(core::enum_name(result.estimator));
    info["samples_per_pair"] = result.samples_per_pair;
    info["seconds"] = result.seconds;
    info["interrupted"] = result.interrupted;
    info["settings"] = core::write_value(description);
    return info;
}

}  // namespace

RenderJob render_to_file(const std::string& scene_path,
                         const std::vector<std::string>& overrides,
                         const std::string& capture_path) {
    // A target that cannot be written is found before the work, not after it.
    const core::OutputFile probe(capture_path);
    const renderer::SceneDescription description =
        renderer::read_scene_description(scene_path, overrides);
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene = renderer::load_scene(description, scan);

    ProgressBar bar("render");
    renderer::RenderResult result =
        renderer::render(scene, scan, description.time_axis, description.render, bar.progress());
    result.capture.scene_info = provenance(scene_path, description, result);
    nlos::write_capture(capture_path, result.capture);

    RenderJob job;
    job.num_pairs = scan.num_pairs();
    job.num_bins = description.time_axis.num_bins;
    job.pattern = core::enum_name(scan.pattern);
    job.estimator = core::enum_name(result.estimator);
    job.samples_per_pair = result.samples_per_pair;
    job.seconds = result.seconds;
    job.interrupted = result.interrupted;
    return job;
}

}  // namespace apps
