// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/commands.h"
#include "apps/commands/reconstruct_job.h"
#include "apps/terminal.h"
#include "renderer/core/parallel.h"

#include <fmt/core.h>

#include <memory>

namespace apps {
namespace {

struct ReconstructArguments {
    std::vector<std::string> captures;
    std::string output;
    std::string method;
    std::string ply;
    std::string glb;
    std::string calibration;
    std::vector<std::string> overrides;
    int threads = 0;
};

void run(const ReconstructArguments& arguments) {
    const core::ThreadLimit threads(arguments.threads);
    std::vector<std::string> overrides = arguments.overrides;
    if (!arguments.method.empty()) overrides.push_back("method=" + arguments.method);
    const nlos::Reconstruction result = reconstruct_to_file(arguments.captures,
                                                            overrides,
                                                            arguments.output,
                                                            arguments.ply,
                                                            arguments.glb,
                                                            arguments.calibration);
    for (const std::string& warning : result.warnings) {
        print_error("warning: {}\n", warning);
    }
    const nlos::VolumeAxes& axes = result.volume.axes;
    print("wrote {}, {}{}{} ({}, {} x {} x {} voxels, {} surface points, {:.2f} s)\n",
          arguments.output,
          with_suffix(arguments.output, ".png"),
          arguments.ply.empty() ? "" : ", " + arguments.ply,
          arguments.glb.empty() ? "" : ", " + arguments.glb,
          result.method,
          axes.x_m.size(),
          axes.y_m.size(),
          axes.z_m.size(),
          result.points.positions.size(),
          result.seconds);
}

}  // namespace

void add_reconstruct_command(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("reconstruct", "Reconstruct the hidden scene from a capture");
    const auto arguments = std::make_shared<ReconstructArguments>();
    command
        ->add_option("CAPTURE",
                     arguments->captures,
                     "Capture in any readable format; several files: the frames of a sequence")
        ->required();
    add_output_option(*command, arguments->output, "Volume to write (.h5); a .png goes beside it")
        ->required();
    command->add_option("--method",
                        arguments->method,
                        "Method: auto, lct, dlct, fk, phasor, bp or fbp (default auto)");
    command->add_option("--ply", arguments->ply, "Also write the surface points (.ply)");
    command->add_option("--glb", arguments->glb, "Also write the surface as a mesh (.glb)");
    command->add_option(
        "--calibration", arguments->calibration, "Calibration of the set-up (.json)");
    add_threads_option(*command, arguments->threads);
    add_capture_options(*command, arguments->overrides);
    command->footer(settings_footer(core::settings_help(ReconstructOptions{}),
                                    "nlos reconstruct data/letter.h5 -o volume.h5 --method lct"));
    command->callback([arguments] { run(*arguments); });
}

}  // namespace apps
