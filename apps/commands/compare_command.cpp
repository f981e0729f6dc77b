// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/commands.h"
#include "apps/commands/compare_job.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <cmath>
#include <memory>

namespace apps {
namespace {

struct CompareArguments {
    std::string a;
    std::string b;
    std::string output;
    double fscore_threshold_m = 0.01;
};

void run(const CompareArguments& arguments) {
    if (!(arguments.fscore_threshold_m > 0.0 && std::isfinite(arguments.fscore_threshold_m))) {
        throw core::Error("--fscore-threshold-m",
                          fmt::format("found {}", arguments.fscore_threshold_m),
                          "must be positive and finite [m]");
    }
    const nlos::Metrics metrics =
        compare_files(arguments.a, arguments.b, arguments.output, arguments.fscore_threshold_m);
    nlos::Metrics copy = metrics;
    for_each_field(copy, [](const char* name, const auto& value, const char* meaning) {
        if (value) fmt::print("{:<20} {:<12.6g} {}\n", name, static_cast<double>(*value), meaning);
    });
    if (!arguments.output.empty()) fmt::print("wrote {}\n", arguments.output);
}

}  // namespace

void add_compare_command(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("compare", "Score a result against the truth or another result");
    const auto arguments = std::make_shared<CompareArguments>();
    command
        ->add_option("A",
                     arguments->a,
                     "Volume, capture (.h5), fit (.json), point cloud or mesh (.ply, .glb)")
        ->required();
    command->add_option("B", arguments->b, "scene.json as the truth, or another of A's kind")
        ->required();
    command->add_option("-o,--output", arguments->output, "Metrics to write (.json)");
    command
        ->add_option("--fscore-threshold-m",
                     arguments->fscore_threshold_m,
                     "Distance that counts as a match for clouds and meshes [m]")
        ->capture_default_str();
    command->footer(settings_footer(
        {}, "nlos compare scenes/letter/scene.glb scenes/letter/scene.json -o metrics.json"));
    command->callback([arguments] { run(*arguments); });
}

}  // namespace apps
