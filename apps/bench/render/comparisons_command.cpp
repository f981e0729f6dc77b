// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/render/comparison_pictures.h"
#include "apps/bench/render/comparisons.h"
#include "apps/commands.h"

namespace apps {
namespace {

struct ComparisonArguments {
    std::string chart_scene = "scenes/relief/scene.json";
    std::string progress_scene = "scenes/room/scene.json";
    std::string only;
    double seconds = 5.0;
    int frames = 20;
    int repeats = 1;
    int reference_samples = 60'000;
};

constexpr int kProgressFrames = 8;

const char* const kWalks = "render.restir.walks";

// A gate that moves by a quarter of its width per frame: history is worth something, if the shift
// can take it along.
SequenceCase moving_gate(const std::string& name, const ComparisonArguments& arguments) {
    return {.name = name,
            .scene = arguments.chart_scene,
            .overrides = {},
            .gate_start_m = 4.0,
            .gate_width_mm = 20.0,
            .gate_step_mm = 5.0,
            .num_frames = arguments.frames,
            .reference_samples = arguments.reference_samples};
}

// The late light of a scene at rest, as a histogram, frame by frame.
SequenceCase resting_histogram(const ComparisonArguments& arguments) {
    return {.name = "progress",
            .scene = arguments.progress_scene,
            .overrides = {"camera.resolution=[64,48]", "render.max_bounces=4"},
            .gate_start_m = 3.8,
            .gate_width_mm = 20.0,
            .gate_step_mm = 0.0,
            .num_frames = kProgressFrames,
            .num_bins = 24,
            .reference_samples = arguments.reference_samples};
}

ComparedMethod restir_with(const std::string& name, const std::vector<std::string>& overrides) {
    ComparedMethod method{name,
                          {"render.method=restir",
                           "render.restir.candidates=ellipsoidal",
                           "render.restir.confidence_cap=8",
                           "render.restir.neighbours=3"},
                          kWalks};
    method.overrides.insert(method.overrides.end(), overrides.begin(), overrides.end());
    return method;
}

std::vector<ComparedMethod> methods_with(const std::string& key,
                                         const std::vector<std::string>& values,
                                         const std::vector<std::string>& overrides) {
    std::vector<ComparedMethod> methods;
    for (const std::string& value : values) {
        std::vector<std::string> all = overrides;
        all.push_back(key + "=" + value);
        methods.push_back(restir_with(value, all));
    }
    return methods;
}

std::vector<ComparedMethod> progress_methods() {
    const std::vector<std::string> memory{"render.restir.confidence_cap=20",
                                          "render.restir.neighbours=1"};
    std::vector<std::string> naive = memory;
    naive.emplace_back("render.restir.reuse=naive");
    return {{"path", {"render.method=path"}, "render.samples"},
            restir_with("naive reuse", naive),
            restir_with("restir", memory)};
}

// One of the figures: what is rendered, by which methods, in how much time per frame.
struct FigurePlan {
    SequenceCase sequence;
    std::vector<ComparedMethod> methods;
    double seconds_per_frame;
};

std::vector<FigurePlan> plan_figures(const ComparisonArguments& arguments) {
    const double per_frame = arguments.seconds / arguments.frames;
    return {{moving_gate("charts", arguments),
             methods_with("render.restir.chart", {"plane", "hemisphere", "adaptive"}, {}),
             per_frame},
            {moving_gate("gauges", arguments),
             methods_with("render.restir.gauge",
                          {"average", "start", "fixed", "midpoint", "symmetric", "flow"},
                          {"render.restir.chart=plane"}),
             per_frame},
            {resting_histogram(arguments), progress_methods(), per_frame}};
}

BenchResult measure(const ComparisonArguments& arguments, const core::Progress& progress) {
    BenchResult result;
    for (const FigurePlan& plan : plan_figures(arguments)) {
        const std::string& name = plan.sequence.name;
        if (!arguments.only.empty() && name != arguments.only) continue;
        const Comparison comparison = compare_methods(
            plan.sequence, plan.methods, plan.seconds_per_frame, arguments.repeats, progress);
        const bool shows_progress = name == "progress";
        result.pictures["_" + name] = shows_progress
                                          ? BenchPicture{progress_panels(comparison), 5}
                                          : BenchPicture{error_panels(comparison), 3};
        if (shows_progress) result.plots["_progress_error"] = progress_plot(comparison);
        result.figures["comparisons"].push_back(core::write_value(comparison));
    }
    return result;
}

void declare(CLI::App& command, ComparisonArguments& arguments) {
    command.add_option("--only", arguments.only, "One of them")
        ->check(one_of({"charts", "gauges", "progress"}));
    add_setting(command, "--chart-scene", arguments.chart_scene, "Image for charts and gauges")
        ->type_name("FILE");
    add_setting(command, "--progress-scene", arguments.progress_scene, "Image for progress")
        ->type_name("FILE");
    CLI::Option* seconds = add_setting(
        command, "--seconds", arguments.seconds, "CPU time of a method for all frames [s]");
    limit(*seconds->type_name("S"), {.low = 0});
    add_setting(command, "--frames", arguments.frames, "Frames of the moving gate", {4, 10'000});
    add_setting(command, "--repeats", arguments.repeats, "Runs per method", {1, 1000});
    add_setting(command,
                "--reference-samples",
                arguments.reference_samples,
                "Paths per pair of each of the two references",
                {1, 100'000'000});
}

}  // namespace

void add_bench_comparisons_command(CLI::App& bench) {
    add_benchmark<ComparisonArguments>(
        bench,
        {"comparisons",
         "Equal-time pictures: charts, gauges, progress from frame to frame",
         "nlos bench comparisons -o out/bench --only charts"},
        declare,
        measure);
}

}  // namespace apps
