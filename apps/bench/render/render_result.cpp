// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/render/render.h"
#include "apps/commands.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

namespace apps {
namespace {

// What was asked of the renderers, and what this run says of it.
std::vector<Target> targets_of(const RenderBench& bench) {
    std::vector<Target> targets;
    const auto add =
        [&](const std::string& name, const std::string& asked, double ours, bool holds) {
            targets.push_back({name, asked, fmt::format("{:.3g}", ours), holds});
        };
    for (const EqualError& equal : bench.equal_error) {
        if (equal.method != "third_bounce" || equal.at_rel_l2 > 0.02) continue;
        add(fmt::format("third_bounce over path at {:g}", equal.at_rel_l2),
            ">= 100 times faster",
            equal.time_ratio,
            equal.time_ratio >= 100.0);
    }
    for (const ThirdBounceCost& cost : bench.third_bounce) {
        const bool is_histogram = cost.share == 1.0;
        const bool is_gate = cost.measurement.starts_with("gate");
        const double limit = is_histogram ? 4.0 : is_gate ? 0.1 : 20.0;
        const double ours = is_gate ? cost.share : cost.cpu_seconds;
        add("third_bounce to 1 %, " + cost.measurement,
            fmt::format("<= {:g} {}", limit, is_gate ? "of the histogram" : "CPU s"),
            ours,
            ours <= limit);
    }
    if (!bench.target_errors.empty()) {
        const auto share = [&](bool TargetError::*member) {
            return static_cast<double>(std::ranges::count(bench.target_errors, true, member)) /
                   static_cast<double>(bench.target_errors.size());
        };
        add("random scenes below their target error",
            ">= 0.95 of them",
            share(&TargetError::met),
            share(&TargetError::met) >= 0.95);
        add("random scenes five times below, a coarser cut left",
            "<= 0.05 of them",
            share(&TargetError::is_far_below),
            share(&TargetError::is_far_below) <= 0.05);
    }
    for (const Agreement& agreement : bench.agreement) {
        add(fmt::format("third_bounce and path, {}, {}", agreement.scene, agreement.pattern),
            "chance of the farthest bin >= 0.001",
            agreement.p_value,
            agreement.p_value >= 0.001);
    }
    for (const GateTable& table : bench.gates) {
        for (const GateBench& gate : table.gates) {
            if (gate.method != "ellipsoidal" || gate.gate_mm != 1.0) continue;
            add(fmt::format("ellipsoidal over path, {}, {} bounces, gate of 1 mm",
                            table.scene,
                            table.max_bounces),
                ">= 10 times in equal time",
                gate.gain,
                gate.gain >= 10.0);
        }
    }
    return targets;
}

Plot gate_plot(const GateTable& table) {
    Plot plot{fmt::format("Equal time, {}, {} bounces", table.scene, table.max_bounces),
              "gate width [mm]",
              "relative MSE after 1 s",
              {}};
    for (const GateBench& gate : table.gates) {
        if (gate.gate_mm == 0.0) continue;
        PlotLine& line = line_named(gate.method, plot);
        line.x.push_back(gate.gate_mm);
        line.y.push_back(gate.rel_mse);
    }
    return plot;
}

Plot scaling_plot(const RenderBench& bench) {
    Plot plot{"Scaling", "triangles, wall points, bins, bounces, threads", "time [s]", {}};
    for (const RenderScaling& scaling : bench.scaling) {
        const std::string title = fmt::format("{}, {}", scaling.method, scaling.of);
        plot.lines.push_back({title, scaling.sizes, scaling.cpu_seconds});
        if (scaling.of != "wall points" && scaling.of != "threads") continue;
        plot.lines.push_back({scaling.of == "threads" ? title + ", shared" : title + ", rays alone",
                              scaling.sizes,
                              scaling.limit_seconds,
                              LineStyle::Limit,
                              static_cast<int>(plot.lines.size()) - 1});
    }
    return plot;
}

Plot curves_plot(const RenderBench& bench) {
    Plot plot{"Error against time, " + bench.scene, "CPU time [s]", "relative L2 error", {}};
    for (const BenchCurve& curve : bench.curves) {
        plot.lines.push_back(
            line_of(curve.method, curve.points, &BenchPoint::cpu_seconds, &BenchPoint::rel_l2));
    }
    const auto ray_seconds = [&](const BenchPoint& point) {
        return bench.ray_limit_seconds * point.samples;
    };
    PlotLine limit = line_of(
        "path, its rays alone", bench.curves.front().points, ray_seconds, &BenchPoint::rel_l2);
    limit.style = LineStyle::Limit;
    limit.limit_of = 0;
    const PlotLine front = pareto_front(plot.lines);
    plot.lines.push_back(limit);
    plot.lines.push_back(front);
    return plot;
}

void declare(CLI::App& command, RenderBenchSettings& settings) {
    add_setting(command, "--scene", settings.scene, "Scene description")->type_name("FILE");
    add_setting(command, "--camera-scene", settings.camera_scene, "Image to try gates on")
        ->type_name("FILE");
    add_setting(command,
                "--exclusion-scenes",
                settings.exclusion_scenes,
                "Scenes with surfaces to exclude from ellipsoidal connections")
        ->type_name("FILE");
    add_setting(command,
                "--agreement-scenes",
                settings.agreement_scenes,
                "Confocal scans on which third_bounce and path are compared bin by bin")
        ->type_name("FILE");
    add_setting(command, "--part", settings.part, "What to measure")
        ->check(
            one_of({"all", "curves", "third_bounce", "accuracy", "gates", "exclusion", "scaling"}));
    add_setting(command, "--repeats", settings.repeats, "Runs per point", {1, 1000});
    command.add_flag("--quick", settings.quick, "Leave out what takes longest");
}

}  // namespace

BenchResult measure_render(const RenderBenchSettings& settings, const core::Progress& progress) {
    const RenderBench bench = bench_render(settings, progress);
    BenchResult result{{{"targets", core::write_value(targets_of(bench))}}};
    result.figures.update(core::write_value(bench));
    if (!bench.curves.empty()) result.plots[""] = curves_plot(bench);
    if (!bench.scaling.empty()) result.plots["_scaling"] = scaling_plot(bench);
    for (const GateTable& table : bench.gates) {
        const auto scene = std::filesystem::path(table.scene).parent_path().filename();
        result.plots[fmt::format("_gates_{}_{}", scene.string(), table.max_bounces)] =
            gate_plot(table);
    }
    return result;
}

void add_bench_render_command(CLI::App& bench) {
    add_benchmark<RenderBenchSettings>(
        bench,
        {"render", "Every estimator on one scene", "nlos bench render -o out/bench --quick"},
        declare,
        measure_render);
}

}  // namespace apps
