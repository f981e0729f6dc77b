// Renders a scene, reconstructs it, fits it, and says how far off both are.
#include "calib/compare_fit.h"
#include "calib/fit.h"
#include "nlos/compare/compare.h"
#include "nlos/reconstruct.h"
#include "renderer/core/error.h"
#include "renderer/render.h"
#include "renderer/scene/ground_truth.h"
#include "renderer/scene/load_geometry.h"

#include <cstdio>

namespace {

void run(const char* scene_path) {
    // The settings are those of `nlos render --help`; here a smaller scan than the file asks for.
    const renderer::SceneDescription description =
        renderer::read_scene_description(scene_path, {"scan.sensing_points=[32,32]"});
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene = renderer::load_scene(description, scan);
    const core::Progress silent;  // its callbacks would tell of progress and warnings

    const renderer::RenderResult rendered =
        renderer::render(scene, scan, {description.time_axis, {}}, description.render, silent);

    nlos::ReconstructSettings settings;
    settings.method = nlos::Method::Lct;
    const nlos::Reconstruction result = nlos::reconstruct(rendered.capture, settings, silent);
    const nlos::VolumeAxes& axes = result.volume.axes;
    const nlos::Metrics metrics = nlos::compare_to_truth(
        result,
        renderer::trace_true_surface(scene, description, axes.world_from_wall, axes.x_m, axes.y_m));
    std::printf("reconstruction: depth off by %.1f mm\n", 1e3 * metrics.depth_mae_m.value_or(0));

    // The fit starts from the same objects, 3 cm further away.
    const renderer::SceneGeometry truth = renderer::load_geometry(description);
    calib::FitInput input{rendered.capture, description, truth, {}, {}, {}};
    for (renderer::Object& object : input.geometry.objects) {
        for (core::Vec3& vertex : object.mesh.vertices) vertex.z() += 0.03;
    }
    input.settings.free.objects = {{truth.objects.front().name, {"translation"}}};
    const calib::FitResult fit = calib::fit_scene(input, silent);
    const calib::FitErrors errors = calib::compare_fit(fit, fit.geometry, truth);
    std::printf("fit: position off by %.2f mm\n", 1e3 * errors.position_m.value_or(0));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: consumer SCENE.json\n");
        return 2;
    }
    try {
        run(argv[1]);
    } catch (const core::Error& error) {  // a wrong file or setting: one line, with the remedy
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    } catch (const core::Failure& failure) {  // all else, such as too little memory
        std::fprintf(stderr, "%s\n", failure.what());
        return 1;
    }
}
