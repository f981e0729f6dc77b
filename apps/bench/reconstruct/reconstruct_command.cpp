// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/commands.h"

#include <memory>

namespace apps {
namespace {

struct Arguments {
    BenchOutput output;
    ReconstructBenchSettings settings;
};

void run(const Arguments& arguments) {
    run_benchmark(arguments.output, "reconstruct", [&](const core::Progress& progress) {
        return reconstruct_result(bench_reconstruct(arguments.settings, progress));
    });
}

}  // namespace

void add_bench_reconstruct_command(CLI::App& bench) {
    const auto arguments = std::make_shared<Arguments>();
    ReconstructBenchSettings& settings = arguments->settings;
    CLI::App* command =
        bench.add_subcommand("reconstruct", "Time, memory and accuracy of every method");
    add_output_options(*command, arguments->output);
    command->add_option("--scenes", settings.scenes_folder, "Folder of the scenes")
        ->capture_default_str();
    command->add_option("--capture", settings.capture, "Also score this capture of the letter T");
    command->add_option("--part", settings.part, "What to measure")
        ->capture_default_str()
        ->check(CLI::IsMember({"all", "time", "accuracy", "scaling"}));
    command->add_option("--repeats", settings.repeats, "Runs per median")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    add_threads_option(*command, settings.threads);
    command->add_option("--largest", settings.largest, "Largest side of the scaling curves")
        ->capture_default_str()
        ->check(CLI::Range(32, 256));
    command->footer(settings_footer({}, "nlos bench reconstruct -o out/bench"));
    command->callback([arguments] { run(*arguments); });
}

}  // namespace apps
