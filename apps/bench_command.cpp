// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench_render.h"
#include "apps/bench_sequences.h"
#include "apps/bench_shift.h"
#include "apps/commands.h"
#include "apps/gnuplot.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "renderer/core/output_file.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>

namespace apps {
namespace {

namespace fs = std::filesystem;

struct BenchArguments {
    std::string folder;
    std::string scene = "scenes/bars/scene.json";
    std::string camera_scene = "scenes/box/scene.json";
    std::string exclusion_scene = "scenes/corner/scene.json";
    int repeats = 1;
};

struct SequenceArguments {
    std::string folder;
    std::string scene = "scenes/bars/scene.json";
    std::string image_scene = "scenes/room/scene.json";
    std::string only;
    int frames = 60;
    int repeats = 4;
};

std::string gate_name(double gate_mm) {
    return gate_mm > 0.0 ? fmt::format("{:g} mm", gate_mm) : "histogram";
}

std::string gates_text(const GateTable& table) {
    std::string text =
        fmt::format("\n{}, gates about {:.3f} m: relative MSE after one CPU second\n",
                    table.scene,
                    table.center_m);
    text += fmt::format("{:<12} {:>11} {:>12} {:>9} {:>20}\n",
                        "gate",
                        "path",
                        "ellipsoidal",
                        "ratio",
                        "trimmed ratio");
    for (const GateBench& gate : table.gates) {
        text += fmt::format("{:<12} {:>11.2e} {:>12.2e} {:>9.3g} +- {:<7.2g} {:>9.3g}\n",
                            gate_name(gate.gate_mm),
                            gate.path_rel_mse,
                            gate.ellipsoidal_rel_mse,
                            gate.ratio,
                            gate.ratio_sigma,
                            gate.trimmed_ratio);
    }
    if (table.crossing_mm > 0.0) {
        text += fmt::format("they cross at {:.3g} mm\n", table.crossing_mm);
    } else {
        text += "they do not cross between these gates\n";
    }
    return text;
}

std::string exclusion_text(const std::vector<ExclusionBench>& benches) {
    std::string text = "\nellipsoidal, excluded surfaces: relative variance after one CPU second\n";
    text += fmt::format("{:<28} {:>7} {:<10} {:>8} {:>5} {:>10} {:>7}\n",
                        "scene",
                        "bounces",
                        "gate",
                        "at",
                        "mode",
                        "variance",
                        "gain");
    for (const ExclusionBench& bench : benches) {
        text += fmt::format("{:<28} {:>7} {:<10} {:>6.2f} m {:>5} {:>10.2e} {:>7.2f}\n",
                            bench.scene,
                            bench.max_bounces,
                            gate_name(bench.gate_mm),
                            bench.center_m,
                            bench.mode,
                            bench.variance_seconds,
                            bench.gain);
    }
    return text;
}

struct ShiftBenchArguments {
    std::string folder;
    std::vector<std::string> scenes{
        "scenes/corner/scene.json", "scenes/letter/scene.json", "scenes/bars/scene.json"};
    int shifts = 20'000;
};

std::string table_of(const RenderBench& bench) {
    std::string text = fmt::format(
        "{}\nreference: {}; a long run of path is {:.2e} away, its own noise {:.2e}\n\n",
        bench.scene,
        bench.reference,
        bench.check_distance,
        bench.check_noise);
    text += fmt::format("{:<14} {:<20} {:>10} {:>10}\n", "method", "effort", "CPU s", "rel. L2");
    for (const BenchCurve& curve : bench.curves) {
        for (const BenchPoint& point : curve.points) {
            text += fmt::format("{:<14} {:<20} {:>10.3f} {:>10.2e}\n",
                                curve.method,
                                point.effort,
                                point.cpu_seconds,
                                point.rel_l2);
        }
        text += fmt::format(
            "{:<14} error = {:.3g} seconds^{:.3f}\n", curve.method, curve.coefficient, curve.slope);
    }
    for (const EqualError& equal : bench.equal_error) {
        text += fmt::format(
            "at {} third_bounce is {:.0f} times faster than path ({:.3g} s, {:.3g} s)\n",
            equal.rel_l2,
            equal.ratio,
            equal.third_bounce_seconds,
            equal.path_seconds);
    }
    for (const GateTable& table : bench.gates) text += gates_text(table);
    return text + exclusion_text(bench.exclusion);
}

LogPlot gate_plot(const GateTable& table) {
    LogPlot plot{"Equal time, " + table.scene, "gate width [mm]", "relative MSE after 1 s", {}};
    PlotLine path{"path", {}, {}};
    PlotLine ellipsoidal{"ellipsoidal", {}, {}};
    for (const GateBench& gate : table.gates) {
        if (gate.gate_mm == 0.0) continue;
        path.x.push_back(gate.gate_mm);
        path.y.push_back(gate.path_rel_mse);
        ellipsoidal.x.push_back(gate.gate_mm);
        ellipsoidal.y.push_back(gate.ellipsoidal_rel_mse);
    }
    plot.lines = {path, ellipsoidal};
    return plot;
}

LogPlot plot_of(const RenderBench& bench) {
    LogPlot plot{"Error against time, " + bench.scene, "CPU time [s]", "relative L2 error", {}};
    for (const BenchCurve& curve : bench.curves) {
        PlotLine& line = plot.lines.emplace_back();
        line.title = curve.method;
        for (const BenchPoint& point : curve.points) {
            line.x.push_back(point.cpu_seconds);
            line.y.push_back(point.rel_l2);
        }
    }
    return plot;
}

// The path of a result's files in the folder, which is made when it is not there.
std::string result_stem(const std::string& folder, const std::string& name) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw core::Error(folder, "cannot be made", "must be a writable folder");
    return (fs::path(folder) / name).string();
}

void write_tables(const std::string& stem, core::Json json, const std::string& table) {
    json["program"] = version_text();
    core::write_text_file(stem + ".json", json.dump(2) + "\n");
    core::write_text_file(stem + ".txt", table);
    fmt::print("{}", table);
}

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
    fmt::print("wrote {}\n", stem + ".json");
}

void run_shift(const ShiftBenchArguments& arguments) {
    const std::string stem = result_stem(arguments.folder, "bench_shift");
    ProgressBar bar("bench shift");
    const ShiftBench bench = bench_shift(arguments.scenes, arguments.shifts, bar.progress());
    write_tables(stem, core::write_value(bench), table_of(bench));
    fmt::print("wrote {}\n", stem + ".json");
}

void run_render(const BenchArguments& arguments) {
    const std::string stem = result_stem(arguments.folder, "bench_render");
    ProgressBar bar("bench render");
    const RenderBench bench = bench_render(arguments.scene,
                                           arguments.camera_scene,
                                           arguments.exclusion_scene,
                                           arguments.repeats,
                                           bar.progress());

    write_tables(stem, core::write_value(bench), table_of(bench));
    bool drawn = draw_plot(plot_of(bench), stem);
    for (const GateTable& table : bench.gates) {
        const std::string name = fs::path(table.scene).parent_path().filename().string();
        drawn = draw_plot(gate_plot(table), stem + "_gates_" + name) && drawn;
    }
    if (!drawn) {
        fmt::print(stderr, "bench: gnuplot is not there, so no plot was drawn\n");
    }
    fmt::print("wrote {}\n", stem + ".json");
}

}  // namespace

void add_bench_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("bench", "Measure speed against error");
    command->require_subcommand(1);
    command->footer(settings_footer({}, "nlos bench render -o out/bench"));
    const auto arguments = std::make_shared<BenchArguments>();
    CLI::App* render = command->add_subcommand("render", "Every estimator on one scene");
    render->add_option("-o,--output", arguments->folder, "Folder for JSON, table and plots")
        ->required();
    render->add_option("--scene", arguments->scene, "Scene description")->capture_default_str();
    render->add_option("--camera-scene", arguments->camera_scene, "Image to try gates on")
        ->capture_default_str();
    render
        ->add_option("--exclusion-scene",
                     arguments->exclusion_scene,
                     "Scene with surfaces to exclude from ellipsoidal connections")
        ->capture_default_str();
    render->add_option("--repeats", arguments->repeats, "Runs per point")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    render->footer(settings_footer({}, "nlos bench render -o out/bench"));
    render->callback([arguments] { run_render(*arguments); });

    add_bench_fit_command(*command);
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
}

}  // namespace apps
