// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/commands/render_job.h"
#include "apps/outcome.h"
#include "apps/terminal.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"
#include "renderer/scene/scene_file.h"

#include <fmt/core.h>

#include <array>

namespace apps {
namespace {

struct RenderArguments {
    std::string scene;
    std::string output;
    std::string calibration;
    std::vector<std::string> overrides;  ///< --samples 64 becomes render.samples=64
    int threads = 0;
};

constexpr std::array<Shorthand, 6> kRenderShorthands{
    {{"--method", "render.method", "NAME", "Estimator"},
     {"--samples", "render.samples", "N", "Candidate paths per pair"},
     {"--seconds",
      "render.seconds",
      "S",
      "Render for this long instead [s]; of a sequence, each frame"},
     {"--target-error",
      "render.target_error",
      "E",
      "Render until the relative L2 error over all of H is below this"},
     {"--max-bounces", "render.max_bounces", "K", "Bounces, both on the relay wall included"},
     {"--seed", "render.seed", "N", "Seed of the random numbers"}}};

void note(const renderer::RenderResult& result, const std::string& output) {
    note_written({output, result.capture.scan.has_wall() ? "" : with_suffix(output, ".png")});
    outcome()["estimator"] = estimator_names(result);
    outcome()["pairs"] = result.capture.scan.num_pairs();
    outcome()["bins"] = result.capture.time_axis.num_bins;
    if (const auto& sequence = result.capture.sequence) {
        outcome()["frames"] = sequence->frames.size();
    }
    outcome()["samples_per_pair"] = result.samples_per_pair;
    outcome()["estimated_error"] = core::write_value(result.estimated_error);
    outcome()[core::kLeftOutOrdersKey] = core::write_value(result.left_out);
    outcome()["interrupted"] = result.interrupted;
    outcome()["seconds_render"] = result.seconds;
}

std::string averages_of(const renderer::SmoothingWidths& widths) {
    const std::string points = fmt::format("{} points", widths.points - 1);
    const std::string bins = fmt::format("{} bins", widths.bins - 1);
    return fmt::format("orders from 4 on averaged over {} to either side, ",
                       widths.points == 1 ? bins
                       : widths.bins == 1 ? points
                                          : points + " and " + bins);
}

void run(const RenderArguments& arguments) {
    const core::ThreadLimit threads(arguments.threads);
    const renderer::RenderResult result = render_to_file(
        arguments.scene, arguments.overrides, arguments.output, arguments.calibration);
    note(result, arguments.output);
    std::string effort;
    if (result.estimated_error)
        effort += fmt::format("error about {:.1e}, ", *result.estimated_error);
    if (const auto& orders = result.left_out) {
        effort += fmt::format(
            "of which {:.1e} for what is left out: {}, ", orders->error, core::describe(*orders));
    }
    if (result.smoothing) effort += averages_of(*result.smoothing);
    if (result.samples_per_pair > 0)
        effort += fmt::format("{} samples per pair, ", result.samples_per_pair);
    if (result.interrupted) {
        throw core::Failure("render",
                            fmt::format("interrupted; {} holds what was computed ({}{:.2f} s)",
                                        arguments.output,
                                        effort,
                                        result.seconds));
    }
    const core::Capture& capture = result.capture;
    const std::string frames =
        capture.sequence ? fmt::format("{} frames x ", capture.sequence->frames.size()) : "";
    print("wrote {} ({}{} pairs x {} bins, {} by {}, {}{:.2f} s)\n",
          arguments.output,
          frames,
          capture.scan.num_pairs(),
          capture.time_axis.num_bins,
          capture.scan.name(),
          estimator_names(result),
          effort,
          result.seconds);
}

void declare_render(Command& command) {
    auto& arguments = command.runs<RenderArguments>(run);
    command.settings = core::settings_help(renderer::SceneDescription{});
    add_file_option(command, "SCENE", arguments.scene, "Scene description (.json)")->required();
    add_output_option(command, arguments.output, "Capture to write (.h5, .npz, .exr, .mat)")
        ->required();
    add_shorthands(command, kRenderShorthands, arguments.overrides);
    add_file_option(command,
                    "--calibration",
                    arguments.calibration,
                    "Calibration of the set-up to record with (.json)");
    add_threads_option(command, arguments.threads);
    add_set_option(command, arguments.overrides);
}

}  // namespace

extern const CommandRow kRenderCommand{"render",
                                       "Simulate the transients a scan records",
                                       "nlos render scenes/letter/scene.json -o letter.h5",
                                       declare_render};

}  // namespace apps
