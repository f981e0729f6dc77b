// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/commands/compare_job.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <cmath>
#include <optional>

namespace apps {
namespace {

struct CompareArguments {
    std::string a;
    std::string b;
    std::string output;
    std::string picture;
    std::optional<double> fscore_threshold_m;
    std::vector<std::string> overrides;
};

void run(const CompareArguments& arguments) {
    const auto& threshold = arguments.fscore_threshold_m;
    if (threshold && !(*threshold > 0.0 && std::isfinite(*threshold))) {
        throw core::Error("--fscore-threshold-m",
                          fmt::format("found {}", *threshold),
                          "must be positive and finite [m]");
    }
    Comparison comparison = [&] {
        const ProgressBar bar("compare");
        return compare_files(arguments.a,
                             arguments.b,
                             arguments.output,
                             threshold,
                             capture_options(arguments.overrides).capture,
                             arguments.picture);
    }();
    for_each_field(comparison.metrics,
                   [](const char* name, const auto& value, const char* meaning) {
                       if (!value) return;
                       outcome()["metrics"][name] = *value;
                       if (nlos::looks_at_truth(name)) return;
                       print("{:<24} {:<12.6g} {}\n", name, static_cast<double>(*value), meaning);
                   });
    for (const std::string& text : comparison.warnings) warn(text);
    print_written({arguments.output, arguments.picture});
}

void declare_compare(Command& command) {
    auto& arguments = command.runs<CompareArguments>(run);
    command.settings = core::settings_help(CaptureOptions{});
    add_file_option(command,
                    "A",
                    arguments.a,
                    "Volume, capture (.h5), fit or track (.json), point cloud or mesh (.ply, .glb)")
        ->required();
    add_file_option(command, "B", arguments.b, "scene.json as the truth, or another of A's kind")
        ->required();
    add_output_option(command, arguments.output, "Metrics to write (.json)");
    add_picture_option(command, arguments.picture);
    command
        .add_option("--fscore-threshold-m",
                    arguments.fscore_threshold_m,
                    fmt::format("Distance that counts as a match of points [m] (default {}, of "
                                "volumes their voxel diagonal)",
                                kDefaultThreshold_m))
        ->type_name("D");
    add_capture_options(command, arguments.overrides);
}

}  // namespace

extern const CommandRow kCompareCommand{
    "compare",
    "Score a result against the truth or another result",
    "nlos compare scenes/letter/scene.glb scenes/letter/scene.json -o metrics.json",
    declare_compare};

}  // namespace apps
