// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/commands/compare_job.h"
#include "apps/commands/fit_job.h"
#include "apps/commands/reconstruct_job.h"
#include "apps/commands/render_job.h"
#include "apps/outcome.h"
#include "apps/report/report.h"
#include "apps/scene_truth.h"
#include "apps/terminal.h"
#include "nlos/detector/detector.h"
#include "nlos/formats/capture_file.h"
#include "nlos/pictures/picture.h"
#include "nlos/pictures/pictures.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/data_folder.h"

#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;

constexpr double kDemoMatch_m = 0.02;  // of points with the truth, in all scores
constexpr double kDemoPhotons = 1e5;
constexpr double kDemoJitterFwhm_ps = 200.0;

struct DemoArguments {
    std::string folder = "out/demo";
};

void stop_if_interrupted() {
    if (interrupt_requested()) throw core::Failure("demo", "interrupted");
}

void run(const DemoArguments& arguments) {
    const fs::path folder = arguments.folder;
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw core::Error(folder.string(), "cannot be made", "must be a writable folder");
    const auto file = [&](const std::string& name) { return (folder / name).string(); };

    const std::string scene = core::shipped_file("scenes/letter/scene.json");
    print("scene        {}\n", scene);
    nlos::write_panels(
        file("ground_truth.png"), nlos::truth_panels(SceneTruth(scene).depth_map()), 3);
    const renderer::RenderResult render = render_to_file(scene, {}, file("capture.h5"));
    print("capture      {} ({:.2f} s)\n", file("capture.h5"), render.seconds);
    for (const std::string method : {"lct", "bp"}) {
        stop_if_interrupted();
        const std::string volume = file("volume_" + method + ".h5");
        const auto result =
            reconstruct_to_file({{file("capture.h5")}, {"method=" + method}, volume});
        const nlos::Metrics metrics =
            compare_files(volume, scene, file("metrics_" + method + ".json"), kDemoMatch_m).metrics;
        outcome()["depth_mae_m"][method] = core::write_value(metrics.depth_mae_m);
        print("{:<12} {} ({:.2f} s, depth error {:.2f} mm over {:.0f} % of the letter)\n",
              method,
              volume,
              result.seconds,
              1e3 * metrics.depth_mae_m.value_or(0.0),
              1e2 * metrics.depth_coverage.value_or(0.0));
    }
    stop_if_interrupted();
    nlos::DetectorSettings detector;
    detector.photons = kDemoPhotons;
    detector.response.jitter_fwhm_ps = kDemoJitterFwhm_ps;
    const core::Capture counts = nlos::detect(render.capture, detector);
    nlos::write_capture(file("counts.h5"), counts);
    print("{:<12} {} ({:.0g} photons, jitter {} ps)\n",
          "counts",
          file("counts.h5"),
          kDemoPhotons,
          kDemoJitterFwhm_ps);
    const std::string model = (fs::path(scene).parent_path() / "model.json").string();
    const calib::FitResult fit =
        fit_to_file({file("counts.h5"), model, {"response=capture"}, file("fit.json")});
    const nlos::Metrics errors =
        compare_files(file("fit.json"), scene, file("metrics_fit.json"), kDemoMatch_m).metrics;
    print("{:<12} {} ({:.2f} s, position error {:.2f} mm, rotation error {:.2f} deg)\n",
          "fit",
          file("fit.json"),
          fit.seconds,
          1e3 * errors.position_error_m.value_or(0.0),
          errors.rotation_error_deg.value_or(0.0));
    write_report(file("report.html"), read_results_folder(folder.string(), scene), {});
    note_written({file("report.html")});
    outcome()["position_error_m"] = core::write_value(errors.position_error_m);
    print("wrote {}\n", file("report.html"));
}

void declare_demo(Command& command) {
    auto& arguments = command.runs<DemoArguments>(run);
    add_output_folder_option(command, arguments.folder, "Folder for the results")
        ->capture_default_str();
}

}  // namespace

extern const CommandRow kDemoCommand{
    "demo",
    "Scene, capture, reconstruction, fit, comparison and report in one go",
    "nlos demo -o out/demo",
    declare_demo};

}  // namespace apps
