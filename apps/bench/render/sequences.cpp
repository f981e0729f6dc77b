// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/scene.h"
#include "apps/bench/statistics.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"
#include "renderer/frame_sequence.h"
#include "renderer/render.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace apps {
namespace {

/// A gate that moves over a scene, or stands still before one that moves, as frames.
struct SequenceCase {
    std::string name;
    std::string scene;
    std::vector<std::string> overrides;  ///< of scene.json
    double gate_start_m = 0.0;
    double gate_width_mm = 10.0;
    double gate_step_mm = 10.0;  ///< per frame; 0: the gate stands still
    int num_frames = 60;
    int num_bins = 1;  ///< of that width; more of them stand still
    int reference_samples = 20'000;
    double frame_s = 0.0;  ///< time between frames, in which objects move [s]

    bool is_static() const { return gate_step_mm == 0.0 && frame_s == 0.0; }
};

/// What is rendered of a sequence, with a method's overrides of scene.json.
struct SequenceSetup {
    SequenceSetup(const SequenceCase& sequence, const std::vector<std::string>& overrides);

    renderer::SceneDescription description;
    core::Scan scan;
    std::shared_ptr<const renderer::Scene> scene;
};

using SequenceFrames = std::vector<core::Transient>;

// Frames before this fraction of a sequence are left out of the means: reuse has to settle.
constexpr double kSequenceSettlingFraction = 1.0 / 6.0;

bool is_integrable(const SequenceSetup& setup) {
    return setup.scan.has_wall() && setup.description.render.max_bounces == 3;
}

renderer::RenderResult render_all(const SequenceSetup& setup) {
    return renderer::render_frames(
        setup.scene,
        setup.scan,
        setup.description,
        renderer::make_frame_renderer(setup.scan, setup.description.render),
        {});
}

SequenceFrames frames_of(const SequenceSetup& setup) {
    return render_all(setup).capture.sequence->frames;
}

// Gates of a scene at rest, as sums of the bins of one histogram.
SequenceFrames gates_of_histogram(const SequenceSetup& setup, const SequenceCase& sequence) {
    const auto render = [&](const core::TimeAxis& axis) {
        return renderer::render(*setup.scene, setup.scan, axis, setup.description.render, {})
            .capture.transient;
    };
    if (sequence.num_bins > 1) {
        return {static_cast<std::size_t>(sequence.num_frames), render(setup.description.time_axis)};
    }
    const double step_mm =
        sequence.gate_step_mm > 0.0 ? sequence.gate_step_mm : sequence.gate_width_mm;
    const int bins_per_gate = static_cast<int>(std::lround(sequence.gate_width_mm / step_mm));
    const int bins_per_step = sequence.gate_step_mm > 0.0 ? 1 : 0;
    const core::Transient histogram =
        render({sequence.gate_start_m,
                1e-3 * step_mm,
                bins_per_gate + bins_per_step * (sequence.num_frames - 1)});
    SequenceFrames frames;
    for (int f = 0; f < sequence.num_frames; ++f) {
        core::Transient& frame = frames.emplace_back(histogram.num_pairs(), 1);
        for (std::size_t pair = 0; pair < histogram.num_pairs(); ++pair) {
            for (int bin = 0; bin < bins_per_gate; ++bin) {
                frame.histogram(pair)[0] +=
                    histogram.histogram(pair)[static_cast<std::size_t>(f * bins_per_step + bin)];
            }
        }
    }
    return frames;
}

/// A method and the settings that make it.
struct SequenceMethod {
    std::string name;
    std::vector<std::string> overrides;
};

// How one method does on a sequence, on one thread; gains are left open.
core::Json run_method(const SequenceCase& sequence,
                      const SequenceMethod& method,
                      int num_seeds,
                      const std::array<SequenceFrames, 2>& references) {
    SequenceSetup setup(sequence, method.overrides);
    if (renderer::traits_of(setup.description.render.method).is_deterministic) num_seeds = 1;
    SequenceErrors errors(static_cast<std::size_t>(sequence.num_frames));
    renderer::RestirCounts counts;
    double seconds_per_frame = 0.0;
    for (int seed = 0; seed < num_seeds; ++seed) {
        setup.description.render.seed = 1000 + static_cast<std::uint64_t>(seed);
        const double start = core::cpu_seconds();
        const renderer::RenderResult result = render_all(setup);
        seconds_per_frame += (core::cpu_seconds() - start) / num_seeds / sequence.num_frames;
        counts += result.restir_counts;
        errors.add(result.capture.sequence->frames, references[0], references[1]);
    }
    const auto first_settled =
        static_cast<std::size_t>(std::ceil(kSequenceSettlingFraction * sequence.num_frames));
    const ErrorSums settled = errors.settled(first_settled);
    const double all_frames = static_cast<double>(num_seeds) * sequence.num_frames;
    return {{"sequence", sequence.name},  // gate and measurement
            {"method", method.name},      // estimator and candidates
            {"seconds_per_frame", seconds_per_frame},
            {"rel_mse", settled.rel_mse()},  // mean over the later frames and all seeds
            {"trimmed_rel_mse", settled.trimmed_rel_mse()},  // without the worst 0.2 % of values
            {"sum_ratio", settled.sum / settled.reference_sum},
            {"gain", nullptr},
            {"trimmed_gain", nullptr},
            {"accepted_share", counts.shifts.accepted_fraction()},  // of shifts; 0: none was tried
            {"shifts_per_frame", static_cast<double>(counts.shifts.tried()) / all_frames},
            {"merges_per_frame", static_cast<double>(counts.num_merges) / all_frames},
            {"rel_mse_of_frames", errors.rel_mse_of_frames()}};
}

SequenceSetup::SequenceSetup(const SequenceCase& sequence,
                             const std::vector<std::string>& overrides) {
    std::vector<std::string> all = sequence.overrides;
    all.insert(all.end(), overrides.begin(), overrides.end());
    description = read_bench_scene(sequence.scene, all);
    description.time_axis = {
        {sequence.gate_start_m, 1e-3 * sequence.gate_width_mm, sequence.num_bins}};
    description.frames = {sequence.num_frames, 1e-3 * sequence.gate_step_mm, sequence.frame_s};
    description.velocity_axis.reset();
    description.render.variance = false;
    description.render.by_order = false;
    scan = renderer::make_scan(description);
    scene = std::make_shared<const renderer::Scene>(renderer::load_scene(description, scan));
}

/// The frames of a sequence to little noise, third bounces of scans integrated: sums of the bins of
/// one long histogram, or frame by frame where objects move.
SequenceFrames reference_frames(const SequenceCase& sequence, std::uint64_t seed) {
    SequenceSetup setup(sequence, {});
    renderer::RenderSettings& settings = setup.description.render;
    settings.seed = seed;
    settings.samples = sequence.reference_samples;
    if (is_integrable(setup)) {
        settings.method = renderer::Estimator::ThirdBounce;
        settings.target_error = 2e-3;
    } else {
        settings.method =
            setup.scan.has_wall() ? renderer::Estimator::Auto : renderer::Estimator::Restir;
        settings.restir.reuse = renderer::Reuse::None;
        settings.restir.shared_walks = 2000;
        settings.restir.walks = 16;
    }
    if (sequence.frame_s > 0.0) return frames_of(setup);
    return gates_of_histogram(setup, sequence);
}

// Errors of frames as a line over their numbers from 1 on.
nlos::PlotLine line_of_frames(const std::string& title, const std::vector<double>& errors) {
    nlos::PlotLine line{title, {}, {}};
    for (const double error : errors) {
        line.add(static_cast<double>(line.x.size() + 1), std::max(1e-9, error));
    }
    return line;
}

/// Runs methods over a sequence and measures them against two independent references, whose
/// product has no bias from their noise.
///
/// methods     the first is what gains are counted against
/// num_seeds   runs per method
/// rows        gets a row per method
void bench_sequence(const SequenceCase& sequence,
                    const std::vector<SequenceMethod>& methods,
                    int num_seeds,
                    const core::Progress& progress,
                    std::vector<core::Json>& rows) {
    const core::ThreadLimit one_thread(1);
    std::array<SequenceFrames, 2> references{reference_frames(sequence, 1), {}};
    // Integrated ones would be the same twice.
    references[1] =
        is_integrable(SequenceSetup(sequence, {})) ? references[0] : reference_frames(sequence, 2);
    const std::size_t first = rows.size();
    // Relative MSE times seconds, which is what is left after one second.
    const auto cost = [](const core::Json& row, const char* error) {
        return row[error].get<double>() * row["seconds_per_frame"].get<double>();
    };
    for (const SequenceMethod& method : methods) {
        progress.update(fraction_of(rows.size() - first, methods.size()),
                        sequence.name + ", " + method.name);
        core::Json& row = rows.emplace_back(run_method(sequence, method, num_seeds, references));
        row["gain"] = cost(rows[first], "rel_mse") / cost(row, "rel_mse");
        row["trimmed_gain"] = cost(rows[first], "trimmed_rel_mse") / cost(row, "trimmed_rel_mse");
    }
}

struct SequenceArguments {
    std::string only;
    int repeats = 4;
};

std::vector<SequenceCase> standard_sequences() {
    const std::string scan = "scenes/bars/scene.json";
    const std::string resolution = "camera.resolution=[128,96]";
    const SequenceCase third{"scan, order 3", scan, {"render.max_bounces=3"}, 1.4};
    SequenceCase fifth{"scan, order 5", scan, {"render.max_bounces=5"}, 1.4};
    fifth.reference_samples = 4'096;
    const SequenceCase image{
        "camera, 5 vertices", "scenes/room/scene.json", {"render.max_bounces=5", resolution}, 2.6};
    SequenceCase moving_scan{
        "scan, moving objects", "scenes/traffic/scan.json", {"render.max_bounces=3"}, 1.7};
    moving_scan.frame_s = 1e-3;
    SequenceCase moving_image{"camera, moving objects",
                              "scenes/traffic/scene.json",
                              {"render.max_bounces=4", resolution},
                              6.0};
    moving_image.frame_s = 1e-3;
    moving_image.reference_samples = 6'000;

    std::vector<SequenceCase> sequences;
    const auto add = [&](const SequenceCase& kind, double width_mm, double step_mm) {
        SequenceCase& added = sequences.emplace_back(kind);
        added.name += fmt::format(", {}/{} mm", width_mm, step_mm);
        added.gate_width_mm = width_mm;
        added.gate_step_mm = step_mm;
    };
    const std::vector<std::array<double, 2>> gates{
        {20, 20}, {20, 5}, {10, 10}, {10, 2.5}, {5, 2.5}, {2, 2}, {20, 0}};
    for (const SequenceCase& kind : {third, fifth, image}) {
        for (const auto& [width, step] : gates) add(kind, width, step);
    }
    for (const SequenceCase& kind : {moving_scan, moving_image}) {
        add(kind, 20, 0);
        add(kind, 10, 2.5);
    }
    const auto add_histogram = [&](SequenceCase kind, double start_m, int num_bins) {
        kind.name += ", histogram";
        kind.gate_start_m = start_m;
        kind.num_bins = num_bins;
        add(kind, 20, 0);
    };
    add_histogram(third, 1.2, 48);
    add_histogram(image, 3.8, 24);  // late light: without it the direct light holds the error
    return sequences;
}

std::vector<SequenceMethod> standard_methods(const SequenceCase& sequence) {
    const SequenceSetup setup(sequence, {});
    const bool is_image = !setup.scan.has_wall();
    const bool is_static = sequence.is_static();
    // Good candidates leave little for reuse to add: a moving gate then wants a short memory.
    const auto cap = [](int frames) {
        return fmt::format("render.restir.confidence_cap={}", frames);
    };
    const auto near = [&](int moving) {
        return fmt::format("render.restir.neighbours={}", is_static ? 0 : moving);
    };
    // On images few neighbours and more walks keep down what single bright paths do to a pixel.
    const std::string memory = cap(5);
    const std::string few = near(is_image ? 1 : 3);
    const std::string walks = "render.restir.walks=8";
    const std::string shared = fmt::format("render.restir.shared_walks={}", is_image ? 512 : 2048);
    const std::string restir = "render.method=restir";
    const std::string ellipsoidal = "render.restir.candidates=ellipsoidal";
    const std::string on_paths = "render.restir.candidates=path";
    const std::string on_all = "render.restir.candidates=all";
    const std::string alone = "render.restir.reuse=none";
    std::vector<SequenceMethod> methods{
        {"path", {"render.method=path", is_image ? "render.samples=16" : "render.samples=128"}},
        {"restir, default", {restir}},
        {"ellipsoidal",
         {"render.method=ellipsoidal", is_image ? "render.samples=4" : "render.samples=32"}},
        {"naive, ellipsoidal",
         {restir, ellipsoidal, walks, memory, few, "render.restir.reuse=naive"}},
        {"restir, walks", {restir, on_paths, walks, memory, few}},
        {"restir, ellipsoidal", {restir, ellipsoidal, walks, memory, few}},
        {"shared alone", {restir, shared, alone}},
        {"restir, shared", {restir, shared, cap(is_image ? 5 : 2), near(is_image ? 1 : 0)}}};
    if (is_image) {
        const std::string three = "render.restir.walks=3";
        methods.push_back({"all alone", {restir, on_all, three, shared, alone}});
        methods.push_back({"restir, all", {restir, on_all, three, shared, memory, few}});
    }
    if (is_integrable(setup)) {
        methods.push_back({"third_bounce", {"render.method=third_bounce"}});
    }
    return methods;
}

// Error over frames, a plot per sequence.
void add_plot(const core::Json& row, std::map<std::string, nlos::Plot>& plots) {
    const std::string sequence = row["sequence"];
    std::string suffix = "_" + sequence;
    std::replace_if(
        suffix.begin(), suffix.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
    nlos::Plot& plot = plots[suffix];
    plot.title = sequence;
    plot.x_label = "frame";
    plot.y_label = "relative MSE";
    plot.lines.push_back(line_of_frames(row["method"], row["rel_mse_of_frames"]));
}

BenchResult measure(const SequenceArguments& arguments, const core::Progress& progress) {
    std::vector<core::Json> rows;
    for (const SequenceCase& sequence : standard_sequences()) {
        if (sequence.name.find(arguments.only) == std::string::npos) continue;
        bench_sequence(sequence, standard_methods(sequence), arguments.repeats, progress, rows);
    }
    BenchResult result{{{"sequences", rows}}};
    for (const core::Json& row : rows) add_plot(row, result.plots);
    return result;
}

void declare_sequences_bench(Command& command) {
    auto& arguments = add_benchmark(command, measure);
    command.add_option("--only", arguments.only, "Sequences whose names contain this");
    add_setting(command, "--repeats", arguments.repeats, "Runs per method", {1, 1000});
}

}  // namespace

extern const CommandRow kSequencesBench{"sequences",
                                        "Frame sequences: reuse of paths against none",
                                        "nlos bench sequences -o out/bench --only 'scan'",
                                        declare_sequences_bench};

}  // namespace apps
