// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/gnuplot.h"
#include "apps/bench/render/comparisons.h"
#include "apps/commands.h"
#include "nlos/pictures/image_layout.h"
#include "nlos/pictures/light_scale.h"
#include "nlos/pictures/picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

namespace apps {
namespace {

using nlos::ImagePanel;
using nlos::Panel;

constexpr double kBrightShare = 0.01;  ///< of the values of maps, drawn in the last colour
constexpr std::size_t kBlock = 4;      ///< pixels either way, over which differences are averaged

std::string name_of(const MethodComparison& method) {
    return method.figures["method"];
}

ImagePanel image_panel(const core::PinholeCamera& camera,
                       const std::string& title,
                       const std::vector<float>& values) {
    ImagePanel panel = nlos::camera_panel(camera, values);
    panel.title = title;
    panel.x_label.clear();
    panel.y_label.clear();
    return panel;
}

double bright_value(std::vector<float> values) {
    const auto rank =
        static_cast<std::ptrdiff_t>((1.0 - kBrightShare) * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    return double{values[static_cast<std::size_t>(rank)]};
}

// Means of blocks of pixels, at every one of them.
std::vector<float> block_means(const core::PinholeCamera& camera,
                               const std::vector<float>& values) {
    std::vector<float> means(values.size());
    const std::size_t height = camera.height();
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t x0 = i / height / kBlock * kBlock;
        const std::size_t y0 = i % height / kBlock * kBlock;
        double sum = 0.0;
        double count = 0.0;
        for (std::size_t x = x0; x < std::min(camera.width(), x0 + kBlock); ++x) {
            for (std::size_t y = y0; y < std::min(height, y0 + kBlock); ++y) {
                sum += double{values[x * height + y]};
                count += 1.0;
            }
        }
        means[i] = static_cast<float>(sum / count);
    }
    return means;
}

// One bin of every pixel.
std::vector<float> bin_of(const core::Transient& transient, std::size_t bin) {
    std::vector<float> values;
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        values.push_back(transient.histogram(pair)[bin]);
    }
    return values;
}

/// The reference's last frame, the methods' error maps on one scale, and where the first of them
/// does worse or better than the second.
///
/// comparison   of at least two methods, gates of one bin
std::vector<Panel> error_panels(const Comparison& comparison) {
    const core::PinholeCamera& camera = comparison.camera;
    ImagePanel truth =
        image_panel(camera, "Reference, last frame", bin_of(comparison.references[0].back(), 0));
    truth.value_range = {0.0, bright_value(truth.values)};
    truth.value_label = nlos::kRenderedRadiance;
    std::vector<Panel> panels{truth};
    std::vector<float> all;
    for (const MethodComparison& method : comparison.methods) {
        all.insert(all.end(), method.error_map.begin(), method.error_map.end());
    }
    const double top = bright_value(all);
    for (const MethodComparison& method : comparison.methods) {
        ImagePanel panel = image_panel(camera,
                                       fmt::format("{}: relMSE {:.3g}",
                                                   name_of(method),
                                                   method.figures["trimmed_rel_mse"].get<double>()),
                                       method.error_map);
        panel.value_range = {0.0, top};
        panel.value_label = "mean |error| / mean radiance";
        panel.colour_map = nlos::ColourMap::Viridis;
        panels.emplace_back(panel);
    }
    const MethodComparison& first = comparison.methods[0];
    const MethodComparison& second = comparison.methods[1];
    std::vector<float> difference = first.error_map;
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= second.error_map[i];
    ImagePanel panel = image_panel(
        camera,
        fmt::format(
            "Error of {} − {}, {} pixels", name_of(first), name_of(second), kBlock * kBlock),
        block_means(camera, difference));
    panel.value_range = {-0.5 * top, 0.5 * top};
    panel.value_label = "red: " + name_of(second) + " is better";
    panel.colour_map = nlos::ColourMap::Diverging;
    panels.emplace_back(panel);
    return panels;
}

/// One bin of frames 1, 2, 4, ...: a row per method, the reference at its end.
std::vector<Panel> progress_panels(const Comparison& comparison) {
    const core::Transient& truth = comparison.references[0].back();
    std::vector<double> sums(truth.num_bins());
    for (std::size_t i = 0; i < truth.values().size(); ++i) {
        sums[i % sums.size()] += double{truth.values()[i]};
    }
    const auto bin =
        static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
    const std::vector<float> wanted = bin_of(truth, bin);
    const double top = bright_value(wanted);
    std::vector<Panel> panels;
    const auto add = [&](const std::string& title, const std::vector<float>& values) {
        ImagePanel panel = image_panel(comparison.camera, title, values);
        panel.value_range = {0.0, top};
        panels.emplace_back(panel);
    };
    for (const MethodComparison& method : comparison.methods) {
        for (std::size_t frame = 1; frame <= method.frames.size(); frame *= 2) {
            add(fmt::format("{}, frame {}: relMSE {:.2g}",
                            name_of(method),
                            frame,
                            method.figures["rel_mse_of_frames"][frame - 1].get<double>()),
                bin_of(method.frames[frame - 1], bin));
        }
        add("reference", wanted);
    }
    return panels;
}

/// Error against the number of frames.
Plot progress_plot(const Comparison& comparison) {
    Plot plot{"Equal time per frame, " + comparison.sequence.scene, "frame", "relative MSE", {}};
    for (const MethodComparison& method : comparison.methods) {
        plot.lines.push_back(line_of_frames(name_of(method), method.figures["rel_mse_of_frames"]));
    }
    return plot;
}

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
        result.pictures["_" + name] = shows_progress ? BenchPicture{progress_panels(comparison), 5}
                                                     : BenchPicture{error_panels(comparison), 3};
        if (shows_progress) result.plots["_progress_error"] = progress_plot(comparison);
        result.figures["comparisons"].push_back(comparison.figures);
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
