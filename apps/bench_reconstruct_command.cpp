// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench_output.h"
#include "apps/bench_reconstruct.h"
#include "apps/commands.h"
#include "apps/terminal.h"

#include <fmt/core.h>

#include <memory>

namespace apps {
namespace {

struct Arguments {
    std::string folder;
    ReconstructBenchSettings settings;
};

void run(const Arguments& arguments) {
    const std::string stem = result_stem(arguments.folder, "bench_reconstruct");
    ProgressBar bar("bench reconstruct");
    const ReconstructBench bench = bench_reconstruct(arguments.settings, bar.progress());
    write_tables(stem, core::write_value(bench), reconstruct_tables(bench));
    report_results(stem, draw_reconstruct_plots(bench, stem));
}

}  // namespace

void add_bench_reconstruct_command(CLI::App& bench) {
    const auto arguments = std::make_shared<Arguments>();
    ReconstructBenchSettings& settings = arguments->settings;
    CLI::App* command =
        bench.add_subcommand("reconstruct", "Time, memory and accuracy of every method");
    command->add_option("-o,--output", arguments->folder, "Folder for JSON, table and plots")
        ->required();
    command->add_option("--scenes", settings.scenes_folder, "Folder of the scenes")
        ->capture_default_str();
    command->add_option("--capture", settings.capture, "Also score this capture of the letter T");
    command->add_option("--part", settings.part, "What to measure")
        ->capture_default_str()
        ->check(CLI::IsMember({"all", "time", "accuracy", "growth"}));
    command->add_option("--repeats", settings.repeats, "Runs per median")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    command->add_option("--threads", settings.threads, "Threads; 0 takes all processors")
        ->capture_default_str()
        ->check(CLI::Range(0, 1024));
    command->add_option("--largest", settings.largest, "Largest side of the growth curves")
        ->capture_default_str()
        ->check(CLI::Range(32, 256));
    command->footer(settings_footer({}, "nlos bench reconstruct -o out/bench"));
    command->callback([arguments] { run(*arguments); });
}

}  // namespace apps
