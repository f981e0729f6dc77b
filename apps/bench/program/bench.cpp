// SPDX-License-Identifier: MIT
#include "apps/bench/program/bench.h"

#include "apps/bench/command.h"
#include "apps/bench/fit/fit.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/bench/render/regret.h"
#include "apps/bench/render/render.h"
#include "apps/outcome.h"
#include "apps/terminal.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/output_file.h"

#include <filesystem>

namespace apps {
namespace {

constexpr int kQuickFitTrials = 3;
constexpr int kQuickLargest = 64;
constexpr int kQuickJobs = 12;

struct AllArguments {
    BenchOutput output;
    bool quick = false;
};

// The four after each other, each with files of its own, and all in one JSON file to hold a later
// run against.
void run_all(const AllArguments& arguments) {
    RenderBenchSettings render;
    RegretBenchSettings regret;
    ReconstructBenchSettings reconstruct;
    if (arguments.quick) {
        regret.jobs = kQuickJobs;
        regret.most_seconds = 1.0;
        render.part = "curves";
        render.quick = true;
        reconstruct.repeats = 1;
        reconstruct.largest = kQuickLargest;
    }
    FitBenchSettings fit;
    if (arguments.quick) fit.trials = kQuickFitTrials;
    for (const char* name : {"render", "regret", "reconstruct", "fit"}) {
        read_earlier_run(arguments.output.against, name);  // before an hour has passed
    }
    core::Json all;
    const auto add = [&](const std::string& name, const Benchmark& benchmark) {
        all[name] = run_benchmark(arguments.output, name, benchmark);
    };
    add("render", [&](const core::Progress& progress) { return measure_render(render, progress); });
    add("regret", [&](const core::Progress& progress) { return measure_regret(regret, progress); });
    add("reconstruct",
        [&](const core::Progress& progress) { return measure_reconstruct(reconstruct, progress); });
    add("fit", [&](const core::Progress& progress) { return measure_fit(fit, progress); });
    const auto path = std::filesystem::path(arguments.output.folder) / "bench_all.json";
    core::write_text_file(path.string(), core::json_text(all));
    print_written({path.string()});
}

void declare_all_benches(Command& command) {
    auto& arguments = command.runs<AllArguments>(run_all);
    add_output_options(command, arguments.output);
    command.add_flag(
        "--quick", arguments.quick, "Fewer and smaller runs: minutes instead of an hour");
}

constexpr CommandRow kAllBenches{"all",
                                 "These four: render, regret, reconstruct, fit",
                                 "nlos bench all -o out/bench --quick",
                                 declare_all_benches};

}  // namespace

// Each stands in the file of its name.
extern const CommandRow kRenderBench, kRegretBench, kReconstructBench, kFitBench, kNoiseBench,
    kCoverageBench, kWeightsBench, kLongRangeBench, kSequencesBench, kFieldBench;

void declare_bench(Command& command) {
    command.require_subcommand(1);
    for (const CommandRow* row : {&kRenderBench,
                                  &kRegretBench,
                                  &kReconstructBench,
                                  &kFitBench,
                                  &kAllBenches,
                                  &kNoiseBench,
                                  &kCoverageBench,
                                  &kWeightsBench,
                                  &kLongRangeBench,
                                  &kSequencesBench,
                                  &kFieldBench}) {
        add_command(command, *row);
    }
}

}  // namespace apps
