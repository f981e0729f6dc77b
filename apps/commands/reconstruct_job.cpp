// SPDX-License-Identifier: MIT
#include "apps/commands/reconstruct_job.h"

#include "apps/arguments.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "calib/calibrate.h"
#include "nlos/formats/ply_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/pictures/picture.h"
#include "nlos/pictures/pictures.h"
#include "nlos/reconstruction/surface_mesh.h"
#include "renderer/core/output_file.h"
#include "renderer/gltf/gltf.h"

#include <fmt/ranges.h>

namespace apps {
namespace {

void write_surface(const std::string& glb_path, core::TriangleMesh mesh) {
    if (mesh.triangles.empty()) throw core::Failure(glb_path, "no surface was found to write");
    renderer::SceneGeometry geometry;
    geometry.objects.emplace_back();
    geometry.objects.back().name = "reconstruction";
    geometry.objects.back().mesh = std::move(mesh);
    renderer::write_gltf(glb_path, geometry);
}

}  // namespace

nlos::Reconstruction reconstruct_to_file(const std::vector<std::string>& capture_paths,
                                         const std::vector<std::string>& overrides,
                                         const std::string& volume_path,
                                         const std::string& ply_path,
                                         const std::string& glb_path,
                                         const std::string& calibration_path) {
    require_suffix(volume_path, {".h5", ".hdf5"});
    require_suffix(ply_path, {".ply"});
    require_suffix(glb_path, {".glb"});
    std::vector<std::string> inputs = capture_paths;
    inputs.push_back(calibration_path);
    core::check_targets({volume_path, with_suffix(volume_path, ".png"), ply_path, glb_path},
                        inputs);
    ReconstructOptions options;
    for (const std::string& text : overrides) core::apply_override(options, text);
    ProgressBar bar("reconstruct");
    const core::Progress progress = bar.progress();
    progress.stage(1, 3, "reading", 0.0, 0.0);
    core::Capture capture = nlos::read_capture(capture_paths, options.capture);
    if (!calibration_path.empty()) {
        capture = calib::apply_calibration(calib::read_calibration(calibration_path), capture);
    }

    nlos::Reconstruction result = [&] {
        const StoppableWork stoppable(
            "stopping after this step, without a file; Ctrl-C again ends at once");
        return nlos::reconstruct(
            capture, options.reconstruct, progress.stage(2, 3, "reconstructing", 0.0, 1.0));
    }();
    if (progress.should_stop()) throw core::Failure("reconstruct", "interrupted");
    progress.stage(3, 3, "writing", 1.0, 1.0);
    result.provenance = {
        {"program", version_text()},
        {"command", command_line()},
        {"capture", core::printable(fmt::format("{}", fmt::join(capture_paths, " ")))}};
    nlos::write_volume(volume_path, result);
    nlos::write_panels_png(with_suffix(volume_path, ".png"), nlos::volume_panels(result), 2);
    if (!ply_path.empty()) nlos::write_ply(ply_path, result.points);
    if (!glb_path.empty()) write_surface(glb_path, nlos::surface_mesh(result.depth));
    return result;
}

}  // namespace apps
