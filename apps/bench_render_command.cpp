// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench_output.h"
#include "apps/bench_render.h"
#include "apps/commands.h"
#include "apps/gnuplot.h"
#include "apps/terminal.h"
#include "renderer/core/settings.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>

namespace apps {
namespace {

namespace fs = std::filesystem;

struct BenchArguments {
    std::string folder;
    RenderBenchSettings settings;
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

std::string growth_text(const std::vector<RenderGrowth>& growths) {
    if (growths.empty()) return "";
    std::string text = "\ngrowth: CPU seconds at each size, fitted exponent, exponent at the end\n";
    for (const RenderGrowth& growth : growths) {
        text += fmt::format("{:<14} {:<12}", growth.method, growth.of);
        for (std::size_t i = 0; i < growth.sizes.size(); ++i) {
            text += fmt::format(" {:>7}: {:<8.3g}", growth.sizes[i], growth.cpu_seconds[i]);
        }
        text += fmt::format(" {:>5.2f} {:>5.2f}\n", growth.exponent, growth.last);
    }
    return text;
}

std::string exclusion_text(const std::vector<ExclusionBench>& benches) {
    if (benches.empty()) return "";
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

std::string curves_text(const RenderBench& bench) {
    if (bench.curves.empty()) return "";
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
    return text;
}

std::string table_of(const RenderBench& bench) {
    std::string text = curves_text(bench);
    for (const GateTable& table : bench.gates) text += gates_text(table);
    return text + exclusion_text(bench.exclusion) + growth_text(bench.growth);
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

LogPlot growth_plot(const RenderBench& bench) {
    LogPlot plot{"Growth", "triangles, wall points, bins, bounces", "CPU time [s]", {}};
    for (const RenderGrowth& growth : bench.growth) {
        plot.lines.push_back(
            {fmt::format("{}, {}", growth.method, growth.of), growth.sizes, growth.cpu_seconds});
    }
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

void run_render(const BenchArguments& arguments) {
    const std::string stem = result_stem(arguments.folder, "bench_render");
    ProgressBar bar("bench render");
    const RenderBench bench = bench_render(arguments.settings, bar.progress());
    write_tables(stem, core::write_value(bench), table_of(bench));
    bool drawn = bench.curves.empty() || draw_plot(plot_of(bench), stem);
    if (!bench.growth.empty()) drawn = draw_plot(growth_plot(bench), stem + "_growth") && drawn;
    for (const GateTable& table : bench.gates) {
        const std::string name = fs::path(table.scene).parent_path().filename().string();
        drawn = draw_plot(gate_plot(table), stem + "_gates_" + name) && drawn;
    }
    report_results(stem, drawn);
}

}  // namespace

void add_bench_render_command(CLI::App& bench) {
    const auto arguments = std::make_shared<BenchArguments>();
    CLI::App* render = bench.add_subcommand("render", "Every estimator on one scene");
    render->add_option("-o,--output", arguments->folder, "Folder for JSON, table and plots")
        ->required();
    RenderBenchSettings& settings = arguments->settings;
    render->add_option("--scene", settings.scene, "Scene description")->capture_default_str();
    render->add_option("--camera-scene", settings.camera_scene, "Image to try gates on")
        ->capture_default_str();
    render
        ->add_option("--exclusion-scene",
                     settings.exclusion_scene,
                     "Scene with surfaces to exclude from ellipsoidal connections")
        ->capture_default_str();
    render->add_option("--part", settings.part, "What to measure")
        ->capture_default_str()
        ->check(CLI::IsMember({"all", "curves", "gates", "exclusion", "growth"}));
    render->add_option("--repeats", settings.repeats, "Runs per point")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    render->footer(settings_footer({}, "nlos bench render -o out/bench"));
    render->callback([arguments] { run_render(*arguments); });
}

}  // namespace apps
