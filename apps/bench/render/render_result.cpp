// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/render/gates.h"
#include "apps/bench/render/render.h"
#include "apps/bench/render/third_bounce.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

namespace apps {
namespace {

constexpr const char* kImageScene = "scenes/box/scene.json";  // where gates are tried, too
/// Where excluding surfaces from ellipsoidal connections is tried: a relay wall, a curved one, and
/// a back wall with its neighbours.
const std::vector<std::string> kExclusionScenes{
    "scenes/bars/scene.json", "scenes/curved/scene.json", "scenes/corner/scene.json"};
/// Confocal scans on which third_bounce and path are compared bin by bin.
const std::vector<std::string> kAgreementScenes{"scenes/letter/scene.json",
                                                "scenes/bars/scene.json",
                                                "scenes/corner/scene.json",
                                                "scenes/glossy/scene.json",
                                                "scenes/animal/scene.json",
                                                "scenes/curved/scene.json"};

double fraction_where(const core::Json& rows, const char* key) {
    const auto holds = [&](const core::Json& row) { return row[key] == true; };
    return fraction_of(std::count_if(rows.begin(), rows.end(), holds), rows.size());
}

// What was asked of the renderers, and what this run's figures say of it.
std::vector<Target> render_targets(const core::Json& figures) {
    std::vector<Target> targets;
    const auto add =
        [&](const std::string& name, const std::string& asked, double ours, bool holds) {
            targets.push_back({name, asked, fmt::format("{:.3g}", ours), holds});
        };
    for (const core::Json& equal : figures["equal_error"]) {
        const double error = equal["at_rel_l2"];
        const double ratio = equal["time_ratio"];
        if (equal["method"] != "third_bounce" || error > 0.02) continue;
        add(fmt::format("third_bounce over path at {:g}", error),
            ">= 100 times faster",
            ratio,
            ratio >= 100.0);
    }
    for (const core::Json& cost : figures["third_bounce"]) {
        const std::string measurement = cost["measurement"];
        const bool is_gate = measurement.starts_with("gate");
        const double limit = measurement == "histogram" ? 4.0 : is_gate ? 0.1 : 20.0;
        const double ours = cost[is_gate ? "share" : "cpu_seconds"];
        add("third_bounce to 1 %, " + measurement,
            fmt::format("<= {:g} {}", limit, is_gate ? "of the histogram" : "CPU s"),
            ours,
            ours <= limit);
    }
    if (const core::Json& errors = figures["target_errors"]; !errors.empty()) {
        const auto fraction = [&](const char* key) { return fraction_where(errors, key); };
        add("random scenes below their target error",
            ">= 0.95 of them",
            fraction("met"),
            fraction("met") >= 0.95);
        add("random scenes five times below where a coarser cut meets it",
            "<= 0.05 of them",
            fraction("is_far_below"),
            fraction("is_far_below") <= 0.05);
    }
    for (const core::Json& agreement : figures["agreement"]) {
        const double p_value = agreement["p_value"];
        add(fmt::format("third_bounce and path, {}, {}",
                        agreement["scene"].get<std::string>(),
                        agreement["pattern"].get<std::string>()),
            "chance of the farthest bin >= 0.001",
            p_value,
            p_value >= 0.001);
    }
    for (const core::Json& table : figures["gates"]) {
        for (const core::Json& gate : table["gates"]) {
            if (gate["method"] != "ellipsoidal" || gate["gate_mm"] != 1.0) continue;
            const double gain = gate["gain"];
            add(fmt::format("ellipsoidal over path, {}, {} bounces, gate of 1 mm",
                            table["scene"].get<std::string>(),
                            table["max_bounces"].get<int>()),
                ">= 10 times in equal time",
                gain,
                gain >= 10.0);
        }
    }
    return targets;
}

nlos::Plot gate_plot(const GateTable& table) {
    nlos::Plot plot{fmt::format("Equal time, {}, {} bounces", table.scene, table.max_bounces),
                    "gate width [mm]",
                    "relative MSE after 1 s",
                    {}};
    for (const GateBench& gate : table.gates) {
        if (gate.gate_mm == 0.0) continue;
        line_named(gate.method, plot).add(gate.gate_mm, gate.rel_mse);
    }
    return plot;
}

nlos::Plot scaling_plot(const std::vector<RenderScaling>& all) {
    nlos::Plot plot{"Scaling", "triangles, wall points, bins, bounces, threads", "time [s]", {}};
    for (const RenderScaling& scaling : all) {
        const std::string title = fmt::format("{}, {}", scaling.method, scaling.of);
        plot.lines.push_back({title, scaling.sizes, scaling.cpu_seconds});
        if (scaling.of != "wall points" && scaling.of != "threads") continue;
        plot.lines.push_back({scaling.of == "threads" ? title + ", shared" : title + ", rays alone",
                              scaling.sizes,
                              scaling.limit_seconds,
                              nlos::LineStyle::Limit,
                              static_cast<int>(plot.lines.size()) - 1});
    }
    return plot;
}

nlos::Plot curves_plot(const std::string& scene,
                       const std::vector<BenchCurve>& curves,
                       double ray_limit_seconds) {
    nlos::Plot plot{"Error against time, " + scene, "CPU time [s]", "relative L2 error", {}};
    for (const BenchCurve& curve : curves) {
        plot.lines.push_back(nlos::line_of(
            curve.method, curve.points, &BenchPoint::cpu_seconds, &BenchPoint::rel_l2));
    }
    const auto ray_seconds = [&](const BenchPoint& point) {
        return ray_limit_seconds * point.samples;
    };
    nlos::PlotLine limit = nlos::line_of(
        "path, its rays alone", curves.front().points, ray_seconds, &BenchPoint::rel_l2);
    limit.style = nlos::LineStyle::Limit;
    limit.limit_of = 0;
    const nlos::PlotLine front = pareto_front(plot.lines);
    plot.lines.push_back(limit);
    plot.lines.push_back(front);
    return plot;
}

void measure_gates(const RenderBenchSettings& settings,
                   int runs,
                   const core::Progress& progress,
                   BenchResult& result) {
    for (const auto& [path, max_bounces] :
         {std::pair(settings.scene, 3), {settings.scene, 5}, {std::string(kImageScene), 0}}) {
        const GateTable table = bench_gates(path, max_bounces, runs, progress);
        const auto scene = std::filesystem::path(path).parent_path().filename();
        result.plots[fmt::format("_gates_{}_{}", scene.string(), table.max_bounces)] =
            gate_plot(table);
        result.figures["gates"].push_back(core::write_value(table));
    }
}

void declare_render_bench(Command& command) {
    auto& settings = add_benchmark(command, measure_render);
    add_setting(command, "--scene", settings.scene, "Scene description")->type_name("FILE");
    add_setting(command, "--part", settings.part, "What to measure")
        ->check(
            one_of({"all", "curves", "third_bounce", "accuracy", "gates", "exclusion", "scaling"}));
    add_setting(command, "--repeats", settings.repeats, "Runs per point", {1, 1000});
    command.add_flag("--quick", settings.quick, "Leave out what takes longest");
}

}  // namespace

BenchResult measure_render(const RenderBenchSettings& settings, const core::Progress& progress) {
    BenchResult result{{{"targets", core::Json::array()},
                        {"scene", settings.scene},
                        {"reference", ""},
                        {"check_distance", 0.0},
                        {"check_noise", 0.0},
                        {"repeats", settings.repeats},
                        {"ray_limit_seconds", 0.0}}};  // of the shadow rays of `path`, per sample
    core::Json& figures = result.figures;
    for (const char* rows : {"curves",
                             "equal_error",
                             "third_bounce",
                             "target_errors",
                             "agreement",
                             "gates",
                             "exclusion",
                             "scaling"}) {
        figures[rows] = core::Json::array();
    }
    constexpr int kMinGateRuns = 3;  // for a standard deviation
    const int gate_runs = std::max(kMinGateRuns, settings.repeats);
    if (settings.has("curves")) {
        const std::vector<BenchCurve> curves = measure_curves(settings, progress, figures);
        result.plots[""] = curves_plot(settings.scene, curves, figures["ray_limit_seconds"]);
    }
    if (settings.has("third_bounce")) {
        figures["third_bounce"] = bench_third_bounce_costs(settings.scene, settings.repeats);
    }
    if (settings.has("accuracy")) {
        figures["agreement"] = bench_agreement(kAgreementScenes, progress);
        figures["target_errors"] = bench_target_errors(settings.quick ? 6 : 24, progress);
    }
    if (settings.has("gates")) measure_gates(settings, gate_runs, progress, result);
    if (settings.has("exclusion")) {
        for (const std::string& path : kExclusionScenes) {
            bench_exclusion(path, gate_runs, figures["exclusion"]);
        }
    }
    if (settings.has("scaling")) {
        const std::vector<RenderScaling> scaling = bench_render_scaling(progress);
        figures["scaling"] = core::write_value(scaling);
        result.plots["_scaling"] = scaling_plot(scaling);
    }
    figures["targets"] = core::write_value(render_targets(figures));
    return result;
}

extern const CommandRow kRenderBench{"render",
                                     "Every estimator on one scene",
                                     "nlos bench render -o out/bench --quick",
                                     declare_render_bench};

}  // namespace apps
