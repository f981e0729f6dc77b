// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench/reconstruct/noise.h"
#include "apps/commands.h"

#include <memory>

namespace apps {
namespace {

struct NoiseBenchArguments {
    BenchOutput output;
    std::string scene = "scenes/bars/scene.json";
    int repeats = 1;
};

void run(const NoiseBenchArguments& arguments) {
    run_benchmark(arguments.output, "noise", [&](const core::Progress& progress) {
        return noise_result(bench_noise(arguments.scene, arguments.repeats, progress));
    });
}

}  // namespace

void add_bench_noise_command(CLI::App& bench) {
    const auto arguments = std::make_shared<NoiseBenchArguments>();
    CLI::App* noise =
        bench.add_subcommand("noise", "Every reconstruction method against the number of photons");
    add_output_options(*noise, arguments->output);
    noise->add_option("--scene", arguments->scene, "Scene description")->capture_default_str();
    noise->add_option("--repeats", arguments->repeats, "Seeds per figure")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    noise->footer(settings_footer({}, "nlos bench noise -o out/bench"));
    noise->callback([arguments] { run(*arguments); });
}

}  // namespace apps
