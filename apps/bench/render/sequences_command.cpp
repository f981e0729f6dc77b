// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench/output.h"
#include "apps/bench/render/sequences.h"
#include "apps/commands.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>

namespace apps {
namespace {

struct SequenceArguments {
    BenchOutput output;
    SequenceScenes scenes;
    std::string only;
    int frames = 60;
    int repeats = 4;
};

std::string sequences_text(const std::vector<SequenceBench>& benches) {
    std::string text =
        fmt::format("{:<36} {:<20} {:>9} {:>10} {:>10} {:>7} {:>8} {:>8} {:>8} {:>9}\n",
                    "sequence",
                    "method",
                    "ms/frame",
                    "relMSE",
                    "trimmed",
                    "sum",
                    "gain",
                    "trimmed",
                    "accepted",
                    "merges");
    for (const SequenceBench& bench : benches) {
        text += fmt::format(
            "{:<36} {:<20} {:>9.1f} {:>10.3e} {:>10.3e} {:>7.4f} {:>8.2f} {:>8.2f} {:>8.2f} "
            "{:>9.0f}\n",
            bench.sequence,
            bench.method,
            1e3 * bench.seconds_per_frame,
            bench.rel_mse,
            bench.trimmed_rel_mse,
            bench.sum_ratio,
            bench.gain,
            bench.trimmed_gain,
            bench.accepted_share,
            bench.merges_per_frame);
    }
    return text;
}

// Error over frames, a plot per sequence.
void add_plot(const SequenceBench& bench, std::map<std::string, LogPlot>& plots) {
    std::string suffix = "_" + bench.sequence;
    std::replace_if(
        suffix.begin(), suffix.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
    LogPlot& plot = plots[suffix];
    plot.title = bench.sequence;
    plot.x_label = "frame";
    plot.y_label = "relative MSE";
    PlotLine line{bench.method, {}, {}, LineStyle::Measured};
    for (const double error : bench.rel_mse_of_frames) {
        line.x.push_back(static_cast<double>(line.x.size() + 1));
        line.y.push_back(std::max(1e-9, error));
    }
    plot.lines.push_back(std::move(line));
}

BenchResult measure(const SequenceArguments& arguments, const core::Progress& progress) {
    std::vector<SequenceBench> benches;
    for (const SequenceCase& sequence : standard_sequences(arguments.scenes, arguments.frames)) {
        if (sequence.name.find(arguments.only) == std::string::npos) continue;
        const auto found =
            bench_sequence(sequence, standard_methods(sequence), arguments.repeats, progress);
        benches.insert(benches.end(), found.begin(), found.end());
    }
    BenchResult result{core::Json::object(), sequences_text(benches), {}, {}};
    result.figures["sequences"] = core::write_value(benches);
    for (const SequenceBench& bench : benches) add_plot(bench, result.plots);
    return result;
}

}  // namespace

void add_bench_sequences_command(CLI::App& bench) {
    const auto sequence = std::make_shared<SequenceArguments>();
    CLI::App* sequences =
        bench.add_subcommand("sequences", "Frame sequences: reuse of paths against none");
    add_output_options(*sequences, sequence->output);
    SequenceScenes& scenes = sequence->scenes;
    sequences->add_option("--scene", scenes.scan, "Scan")->capture_default_str();
    sequences->add_option("--image-scene", scenes.image, "Camera")->capture_default_str();
    sequences->add_option("--image-resolution", scenes.image_resolution, "Pixels, width and height")
        ->capture_default_str()
        ->check(CLI::Range(1, 10'000));
    sequences->add_option("--moving-scene", scenes.moving_scan, "Scan of objects that move")
        ->capture_default_str();
    sequences->add_option("--moving-image-scene", scenes.moving_image, "Camera on such objects")
        ->capture_default_str();
    sequences->add_option("--only", sequence->only, "Sequences whose names contain this");
    sequences->add_option("--frames", sequence->frames, "Frames of a sequence")
        ->capture_default_str()
        ->check(CLI::Range(2, 10'000));
    sequences->add_option("--repeats", sequence->repeats, "Runs per method")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    sequences->footer(settings_footer({}, "nlos bench sequences -o out/bench --only 'scan'"));
    sequences->callback([sequence] {
        run_benchmark(sequence->output, "sequences", [&](const core::Progress& progress) {
            return measure(*sequence, progress);
        });
    });
}

}  // namespace apps
