// SPDX-License-Identifier: MIT
#include "apps/commands/reconstruct_job.h"

#include "apps/arguments.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "calib/calibrate.h"
#include "nlos/formats/volume_file.h"
#include "nlos/pictures/picture.h"
#include "nlos/pictures/pictures.h"
#include "nlos/reconstruction/surface_mesh.h"
#include "renderer/core/mesh_formats/ply_writer.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
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

nlos::Reconstruction reconstruct_to_file(const ReconstructRequest& request) {
    require_suffix(request.volume, {".h5", ".hdf5"});
    require_suffix(request.ply, {".ply"});
    require_suffix(request.glb, {".glb"});
    nlos::check_picture_suffix(request.picture);
    std::vector<std::string> inputs = request.captures;
    inputs.push_back(request.calibration);
    const std::string own_picture = with_suffix(request.volume, ".png");
    core::check_targets({request.volume, own_picture, request.ply, request.glb, request.picture},
                        inputs);
    ReconstructOptions options;
    for (const std::string& text : request.overrides) core::apply_override(options, text);
    ProgressBar bar("reconstruct");
    const core::Progress progress = bar.progress();
    progress.stage(1, 3, "reading", 0.0, 0.0);
    core::Capture capture = nlos::read_capture(request.captures, options.capture);
    if (!request.calibration.empty()) {
        capture = calib::apply_calibration(calib::read_calibration(request.calibration), capture);
    }

    nlos::Reconstruction result = [&] {
        const StoppableWork stoppable(
            "stopping after this step, without a file; Ctrl-C again ends at once");
        return nlos::reconstruct(
            capture, options.settings, progress.stage(2, 3, "reconstructing", 0.0, 1.0));
    }();
    if (progress.should_stop()) throw core::Failure("reconstruct", "interrupted");
    progress.stage(3, 3, "writing", 1.0, 1.0);
    result.provenance = core::Json{
        {"program", version_text()},
        {"command", command_line()},
        {"capture", core::printable(fmt::format("{}", fmt::join(request.captures, " ")))}};
    nlos::write_volume(request.volume, result);
    for (const std::string& path : {own_picture, request.picture}) {
        if (!path.empty()) nlos::write_panels(path, nlos::volume_panels(result), 2);
    }
    if (!request.ply.empty()) core::write_ply(request.ply, result.points);
    if (!request.glb.empty()) write_surface(request.glb, nlos::surface_mesh(result.depth));
    return result;
}

}  // namespace apps
