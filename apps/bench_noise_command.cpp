// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench_noise.h"
#include "apps/bench_output.h"
#include "apps/commands.h"
#include "apps/terminal.h"

#include <fmt/core.h>

#include <memory>

namespace apps {
namespace {

struct NoiseBenchArguments {
    std::string folder;
    std::string scene = "scenes/bars/scene.json";
    int repeats = 1;
};

void run(const NoiseBenchArguments& arguments) {
    const std::string stem = result_stem(arguments.folder, "bench_noise");
    ProgressBar bar("bench noise");
    const NoiseBench bench = bench_noise(arguments.scene, arguments.repeats, bar.progress());
    write_tables(stem, core::write_value(bench), noise_table(bench));
    report_results(stem, draw_noise_plots(bench, stem));
}

}  // namespace

void add_noise_bench(CLI::App& bench) {
    const auto arguments = std::make_shared<NoiseBenchArguments>();
    CLI::App* noise =
        bench.add_subcommand("noise", "Every reconstruction method against the number of photons");
    noise->add_option("-o,--output", arguments->folder, "Folder for JSON, table and plots")
        ->required();
    noise->add_option("--scene", arguments->scene, "Scene description")->capture_default_str();
    noise->add_option("--repeats", arguments->repeats, "Seeds per figure")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    noise->footer(settings_footer({}, "nlos bench noise -o out/bench"));
    noise->callback([arguments] { run(*arguments); });
}

}  // namespace apps
