// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/render/sequences.h"
#include "apps/commands.h"

#include <algorithm>

namespace apps {
namespace {

struct SequenceArguments {
    SequenceScenes scenes;
    std::string only;
    int frames = 60;
    int repeats = 4;
};

// Error over frames, a plot per sequence.
void add_plot(const SequenceBench& bench, std::map<std::string, Plot>& plots) {
    std::string suffix = "_" + bench.sequence;
    std::replace_if(
        suffix.begin(), suffix.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
    Plot& plot = plots[suffix];
    plot.title = bench.sequence;
    plot.x_label = "frame";
    plot.y_label = "relative MSE";
    plot.lines.push_back(line_of_frames(bench.method, bench.rel_mse_of_frames));
}

BenchResult measure(const SequenceArguments& arguments, const core::Progress& progress) {
    std::vector<SequenceBench> benches;
    for (const SequenceCase& sequence : standard_sequences(arguments.scenes, arguments.frames)) {
        if (sequence.name.find(arguments.only) == std::string::npos) continue;
        const auto found =
            bench_sequence(sequence, standard_methods(sequence), arguments.repeats, progress);
        benches.insert(benches.end(), found.begin(), found.end());
    }
    BenchResult result{{{"sequences", core::write_value(benches)}}};
    for (const SequenceBench& bench : benches) add_plot(bench, result.plots);
    return result;
}

void declare(CLI::App& command, SequenceArguments& arguments) {
    SequenceScenes& scenes = arguments.scenes;
    add_setting(command, "--scene", scenes.scan, "Scan")->type_name("FILE");
    add_setting(command, "--image-scene", scenes.image, "Camera")->type_name("FILE");
    CLI::Option* resolution = add_setting(
        command, "--image-resolution", scenes.image_resolution, "Pixels, width and height");
    limit(*resolution, {1, true, 10'000, true});
    add_setting(command, "--moving-scene", scenes.moving_scan, "Scan of objects that move")
        ->type_name("FILE");
    add_setting(command, "--moving-image-scene", scenes.moving_image, "Camera on such objects")
        ->type_name("FILE");
    command.add_option("--only", arguments.only, "Sequences whose names contain this");
    add_setting(command, "--frames", arguments.frames, "Frames of a sequence", {2, 10'000});
    add_setting(command, "--repeats", arguments.repeats, "Runs per method", {1, 1000});
}

}  // namespace

void add_bench_sequences_command(CLI::App& bench) {
    add_benchmark<SequenceArguments>(bench,
                                     {"sequences",
                                      "Frame sequences: reuse of paths against none",
                                      "nlos bench sequences -o out/bench --only 'scan'"},
                                     declare,
                                     measure);
}

}  // namespace apps
