// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench_output.h"
#include "apps/bench_sequences.h"
#include "apps/bench_shift.h"
#include "apps/commands.h"
#include "apps/terminal.h"

#include <fmt/core.h>

#include <memory>

namespace apps {
namespace {

struct SequenceArguments {
    std::string folder;
    std::string scene = "scenes/bars/scene.json";
    std::string image_scene = "scenes/room/scene.json";
    std::string only;
    int frames = 60;
    int repeats = 4;
};

struct ShiftBenchArguments {
    std::string folder;
    std::vector<std::string> scenes{
        "scenes/corner/scene.json", "scenes/letter/scene.json", "scenes/bars/scene.json"};
    int shifts = 20'000;
};

std::string sequences_text(const std::vector<SequenceBench>& benches) {
    std::string text = fmt::format("{:<30} {:<20} {:>9} {:>10} {:>10} {:>7} {:>8} {:>8} {:>8}\n",
                                   "sequence",
                                   "method",
                                   "ms/frame",
                                   "relMSE",
                                   "trimmed",
                                   "sum",
                                   "gain",
                                   "trimmed",
                                   "accepted");
    for (const SequenceBench& bench : benches) {
        text += fmt::format(
            "{:<30} {:<20} {:>9.1f} {:>10.3e} {:>10.3e} {:>7.4f} {:>8.2f} {:>8.2f} {:>8.2f}\n",
            bench.sequence,
            bench.method,
            1e3 * bench.seconds_per_frame,
            bench.rel_mse,
            bench.trimmed_rel_mse,
            bench.sum_ratio,
            bench.gain,
            bench.trimmed_gain,
            bench.accepted_share);
    }
    return text;
}

void run_sequences(const SequenceArguments& arguments) {
    const std::string stem = result_stem(arguments.folder, "bench_sequences");
    ProgressBar bar("bench sequences");
    std::vector<SequenceBench> benches;
    for (const SequenceCase& sequence :
         standard_sequences(arguments.scene, arguments.image_scene, arguments.frames)) {
        if (sequence.name.find(arguments.only) == std::string::npos) continue;
        const auto found = bench_sequence(
            sequence,
            standard_methods(sequence.scene == arguments.image_scene, sequence.gate_step_mm == 0.0),
            arguments.repeats,
            bar.progress());
        benches.insert(benches.end(), found.begin(), found.end());
    }
    core::Json json;
    json["sequences"] = core::write_value(benches);
    write_tables(stem, json, sequences_text(benches));
    report_results(stem, true);
}

void run_shift(const ShiftBenchArguments& arguments) {
    const std::string stem = result_stem(arguments.folder, "bench_shift");
    ProgressBar bar("bench shift");
    const ShiftBench bench = bench_shift(arguments.scenes, arguments.shifts, bar.progress());
    write_tables(stem, core::write_value(bench), table_of(bench));
    report_results(stem, true);
}

}  // namespace

void add_bench_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("bench", "Measure speed against error");
    command->require_subcommand(1);
    command->footer(settings_footer({}, "nlos bench render -o out/bench"));
    add_bench_render_command(*command);
    add_bench_fit_command(*command);
    add_bench_reconstruct_command(*command);
    const auto sequence = std::make_shared<SequenceArguments>();
    CLI::App* sequences =
        command->add_subcommand("sequences", "Frame sequences: reuse of paths against none");
    sequences->add_option("-o,--output", sequence->folder, "Folder for JSON and table")->required();
    sequences->add_option("--scene", sequence->scene, "Scan")->capture_default_str();
    sequences->add_option("--image-scene", sequence->image_scene, "Camera")->capture_default_str();
    sequences->add_option("--only", sequence->only, "Sequences whose names contain this");
    sequences->add_option("--frames", sequence->frames, "Frames of a sequence")
        ->capture_default_str()
        ->check(CLI::Range(2, 10'000));
    sequences->add_option("--repeats", sequence->repeats, "Runs per method")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    sequences->footer(settings_footer({}, "nlos bench sequences -o out/bench --only 'scan'"));
    sequences->callback([sequence] { run_sequences(*sequence); });
    const auto shift_arguments = std::make_shared<ShiftBenchArguments>();
    CLI::App* shift =
        command->add_subcommand("shift", "Gauges and charts of the path-length-aware shift");
    shift->add_option("-o,--output", shift_arguments->folder, "Folder for JSON and table")
        ->required();
    shift->add_option("--scene", shift_arguments->scenes, "Scene descriptions; gauges on the first")
        ->capture_default_str();
    shift->add_option("--shifts", shift_arguments->shifts, "Shifts per scene")
        ->capture_default_str()
        ->check(CLI::Range(1, 100'000'000));
    shift->footer(settings_footer({}, "nlos bench shift -o out/bench"));
    shift->callback([shift_arguments] { run_shift(*shift_arguments); });
    add_noise_bench(*command);
    add_comparisons_bench(*command);
}

}  // namespace apps
