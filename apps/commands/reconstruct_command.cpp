// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/commands/reconstruct_job.h"
#include "apps/outcome.h"
#include "apps/terminal.h"
#include "nlos/methods/methods.h"
#include "nlos/setup_uncertainty.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace apps {
namespace {

struct ReconstructArguments {
    ReconstructRequest request;
    int threads = 0;
};

constexpr std::array kReconstructShorthands{Shorthand{"--method", "method", "NAME", "Method"}};

/// The list of methods, for help.
std::string method_meanings() {
    std::string text = "reconstruction method; auto: by what the capture holds";
    for (const nlos::MethodTraits* method : nlos::kMethods) {
        text += fmt::format("; {}: {}", core::enum_name(method->method), method->meaning);
    }
    return text;
}

void run(const ReconstructArguments& arguments) {
    const core::ThreadLimit threads(arguments.threads);
    const ReconstructRequest& request = arguments.request;
    const nlos::Reconstruction result = reconstruct_to_file(request);
    for (const std::string& warning : result.warnings) warn(warning);
    const nlos::VolumeAxes& axes = result.volume.axes;
    const std::string written = note_written({request.volume,
                                              with_suffix(request.volume, ".png"),
                                              request.ply,
                                              request.glb,
                                              request.picture});
    outcome()["method"] = result.method;
    outcome()["voxels"] = {axes.x_m.size(), axes.y_m.size(), axes.z_m.size()};
    outcome()["surface_points"] = result.points.positions.size();
    outcome()["seconds_reconstruct"] = result.seconds;
    if (result.setup) {
        outcome()["setup"] = nlos::setup_json(result);
        print("set-up: {}\n", nlos::describe(*result.setup));
    }
    print("wrote {} ({}, {} x {} x {} voxels, {} surface points, {:.2f} s)\n",
          written,
          result.method,
          axes.x_m.size(),
          axes.y_m.size(),
          axes.z_m.size(),
          result.points.positions.size(),
          result.seconds);
}

void declare_reconstruct(Command& command) {
    auto& arguments = command.runs<ReconstructArguments>(run);
    command.settings = core::settings_help(ReconstructOptions{});
    std::ranges::find(command.settings, "method", &core::SettingHelp::key)->meaning =
        method_meanings();
    add_file_option(command,
                    "CAPTURE",
                    arguments.request.captures,
                    "Capture in any readable format; several files: the frames of a sequence")
        ->required();
    add_output_option(
        command, arguments.request.volume, "Volume to write (.h5); a .png goes beside it")
        ->required();
    add_shorthands(command, kReconstructShorthands, arguments.request.overrides);
    add_file_option(
        command, "--ply", arguments.request.ply, "Also write the surface points (.ply)");
    add_file_option(
        command, "--glb", arguments.request.glb, "Also write the surface as a mesh (.glb)");
    add_picture_option(command, arguments.request.picture);
    add_file_option(command,
                    "--calibration",
                    arguments.request.calibration,
                    "Calibration of the set-up (.json)");
    add_threads_option(command, arguments.threads);
    add_capture_options(command, arguments.request.overrides);
}

}  // namespace

extern const CommandRow kReconstructCommand{
    "reconstruct",
    "Reconstruct the hidden scene from a capture",
    "nlos reconstruct data/letter.h5 -o volume.h5 --method lct",
    declare_reconstruct};

}  // namespace apps
