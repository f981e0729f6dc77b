// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/fit/fit.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/bench/render/render.h"
#include "apps/commands.h"
#include "apps/outcome.h"
#include "apps/terminal.h"
#include "renderer/core/output_file.h"

#include <filesystem>

namespace apps {
namespace {

constexpr int kQuickFitTrials = 3;
constexpr int kQuickLargest = 64;

struct AllArguments {
    BenchOutput output;
    bool quick = false;
};

// The three after each other, each with files of its own, and all in one JSON file to hold a later
// run against.
void run_all(const AllArguments& arguments) {
    RenderBenchSettings render;
    ReconstructBenchSettings reconstruct;
    if (arguments.quick) {
        render.part = "curves";
        render.quick = true;
        reconstruct.repeats = 1;
        reconstruct.largest = kQuickLargest;
    }
    FitBenchSettings fit;
    if (arguments.quick) fit.trials = kQuickFitTrials;
    for (const char* name : {"render", "reconstruct", "fit"}) {
        read_earlier_run(arguments.output.against, name);  // before an hour has passed
    }
    core::Json all;
    const auto add = [&](const std::string& name, const Benchmark& benchmark) {
        all[name] = run_benchmark(arguments.output, name, benchmark);
    };
    add("render", [&](const core::Progress& progress) { return measure_render(render, progress); });
    add("reconstruct",
        [&](const core::Progress& progress) { return measure_reconstruct(reconstruct, progress); });
    add("fit", [&](const core::Progress& progress) { return measure_fit(fit, progress); });
    const auto path = std::filesystem::path(arguments.output.folder) / "bench_all.json";
    core::write_text_file(path.string(), core::json_text(all));
    print_written({path.string()});
}

}  // namespace

void add_bench_command(CLI::App& app) {
    Command& command = add_command(app, "bench", "Measure speed against error");
    command.require_subcommand(1);
    command.example = "nlos bench reconstruct -o out/bench --part scaling --largest 32";
    add_bench_render_command(command);
    add_bench_reconstruct_command(command);
    add_bench_fit_command(command);
    const auto [all, arguments] =
        add_command<AllArguments>(command, "all", "These three: render, reconstruct, fit", run_all);
    add_output_options(all, arguments.output);
    all.add_flag("--quick", arguments.quick, "Fewer and smaller runs: minutes instead of an hour");
    all.example = "nlos bench all -o out/bench --quick";
    add_bench_noise_command(command);
    add_bench_coverage_command(command);
    add_bench_weights_command(command);
    add_bench_long_range_command(command);
    add_bench_comparisons_command(command);
    add_bench_sequences_command(command);
    add_bench_shift_command(command);
    add_bench_track_command(command);
    add_bench_field_command(command);
}

}  // namespace apps
