// SPDX-License-Identifier: MIT
#include "apps/bench/render/render.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

namespace apps {
namespace {

std::string gate_name(double gate_mm) {
    return gate_mm > 0.0 ? fmt::format("{:g} mm", gate_mm) : "histogram";
}

std::string gates_text(const GateTable& table) {
    std::string text = fmt::format(
        "\n{}, {} bounces, gates about {:.3f} m: relative MSE times CPU seconds, gain over path\n",
        table.scene,
        table.max_bounces,
        table.center_m);
    text += fmt::format(
        "{:<12} {:<14} {:>11} {:>8} {:>20}\n", "gate", "method", "MSE s", "gain", "trimmed gain");
    for (const GateBench& gate : table.gates) {
        text += fmt::format("{:<12} {:<14} {:>11.2e} {:>8.3g} +- {:<7.2g} {:>9.3g}\n",
                            gate_name(gate.gate_mm),
                            gate.method,
                            gate.rel_mse,
                            gate.gain,
                            gate.gain_sigma,
                            gate.trimmed_gain);
    }
    if (table.crossing_mm > 0.0) {
        text += fmt::format("path and ellipsoidal cross at {:.3g} mm\n", table.crossing_mm);
    } else {
        text += "path and ellipsoidal do not cross between these gates\n";
    }
    return text;
}

std::string scaling_text(const std::vector<RenderScaling>& growths) {
    if (growths.empty()) return "";
    std::string text =
        "\ngrowth: size: CPU seconds (with threads elapsed), as many rays alone (with threads the "
        "first shared), memory; fitted exponent, exponent at the end\n";
    for (const RenderScaling& scaling : growths) {
        text += fmt::format("{:<13} {:<12}", scaling.method, scaling.of);
        for (std::size_t i = 0; i < scaling.sizes.size(); ++i) {
            text += fmt::format(" {:>6}: {:<7.3g} {:<8.2g} {:>4.0f} MB",
                                scaling.sizes[i],
                                scaling.cpu_seconds[i],
                                scaling.limit_seconds[i],
                                1e-6 * scaling.peak_bytes[i]);
        }
        text += fmt::format(" {:>5.2f} {:>5.2f}\n", scaling.exponent, scaling.last);
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

std::string third_bounce_text(const RenderBench& bench) {
    if (bench.third_bounce.empty()) return "";
    std::string text = fmt::format(
        "\nthird_bounce to 1 %, {}; millions of rays, and of them per second: while they are "
        "traced, "
        "of the whole, and of Embree alone from single points to places drawn by area\n",
        bench.scene);
    text += fmt::format("{:<28} {:>10} {:>13} {:>10} {:>8} {:>8} {:>8} {:>8}\n",
                        "measurement",
                        "CPU s",
                        "of histogram",
                        "rel. L2",
                        "rays",
                        "tracing",
                        "whole",
                        "Embree");
    for (const ThirdBounceCost& cost : bench.third_bounce) {
        text += fmt::format(
            "{:<28} {:>10.3f} {:>13.3f} {:>10.2e} {:>8.3g} {:>8.2f} {:>8.2f} {:>8.2f}\n",
            cost.measurement,
            cost.cpu_seconds,
            cost.share,
            cost.rel_l2,
            cost.million_rays,
            cost.tracing_rate,
            cost.whole_rate,
            cost.embree_rate);
    }
    return text;
}

std::string target_errors_text(const std::vector<TargetError>& errors) {
    if (errors.empty()) return "";
    const auto count = [&](auto member) { return std::ranges::count(errors, true, member); };
    std::string text = fmt::format(
        "\nthird_bounce to its target on {} random scenes: {} of {} below, {} more than five times "
        "below although a coarser cut is left, {} cut as coarsely as can be; the others:\n",
        errors.back().scene + 1,
        count(&TargetError::met),
        errors.size(),
        count(&TargetError::is_far_below),
        count(&TargetError::is_coarsest));
    text += fmt::format("{:<6} {:<11} {:>7} {:>10} {:>10} {:>8}\n",
                        "scene",
                        "pattern",
                        "target",
                        "rel. L2",
                        "stated",
                        "elements");
    for (const TargetError& error : errors) {
        if (error.met && !error.is_far_below) continue;
        text += fmt::format("{:<6} {:<11} {:>7} {:>10.2e} {:>10.2e} {:>8}\n",
                            error.scene,
                            error.pattern,
                            error.target,
                            error.rel_l2,
                            error.stated,
                            error.elements);
    }
    return text;
}

std::string agreement_text(const std::vector<Agreement>& agreements) {
    if (agreements.empty()) return "";
    std::string text =
        "\nthird_bounce to 0.05 % and path: bins within their 95 % interval, the one farthest off "
        "and "
        "its chance\n";
    text += fmt::format("{:<28} {:<11} {:>6} {:>7} {:>10} {:>8} {:>20}\n",
                        "scene",
                        "pattern",
                        "bins",
                        "within",
                        "largest z",
                        "chance",
                        "energy ratio");
    for (const Agreement& agreement : agreements) {
        text += fmt::format("{:<28} {:<11} {:>6} {:>7.3f} {:>10.2f} {:>8.2g} {:>9.5f} +- {:.5f}\n",
                            agreement.scene,
                            agreement.pattern,
                            agreement.num_bins,
                            agreement.within_95,
                            agreement.largest_z,
                            agreement.p_value,
                            agreement.energy_ratio,
                            agreement.energy_sigma);
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
    text += fmt::format(
        "{:<14} {:<20} {:>10} {:>10} {:>10}\n", "method", "effort", "CPU s", "rel. L2", "spread");
    for (const BenchCurve& curve : bench.curves) {
        for (const BenchPoint& point : curve.points) {
            text +=
                fmt::format("{:<14} {:<20} {:>10.3f} {:>10.2e} {:>10}{}\n",
                            curve.method,
                            point.effort,
                            point.cpu_seconds,
                            point.rel_l2,
                            point.runs > 1 ? fmt::format("{:.2e}", point.rel_l2_spread) : "one run",
                            point.is_on_front ? "  front" : "");
        }
        text += fmt::format(
            "{:<14} error = {:.3g} seconds^{:.3f}\n", curve.method, curve.coefficient, curve.slope);
    }
    const BenchPoint& path = bench.curves.front().points.back();
    text += fmt::format("the shadow rays of path alone would take {:.3g} of its time\n",
                        bench.ray_limit_seconds * path.samples / path.cpu_seconds);
    text += fmt::format("\n{:<14} {:>9} {:>10} {:>10} {:>12} {:>12}\n",
                        "against path",
                        "rel. L2",
                        "CPU s",
                        "path s",
                        "times faster",
                        "less error");
    for (const EqualError& equal : bench.equal_error) {
        text += fmt::format("{:<14} {:>9} {:>10.3g} {:>10.3g} {:>12.3g} {:>12.3g}\n",
                            equal.method,
                            equal.at_rel_l2,
                            equal.cpu_seconds,
                            equal.path_seconds,
                            equal.time_ratio,
                            equal.error_ratio);
    }
    return text;
}

std::string table_of(const RenderBench& bench) {
    std::string text = curves_text(bench) + third_bounce_text(bench) +
                       target_errors_text(bench.target_errors) + agreement_text(bench.agreement);
    for (const GateTable& table : bench.gates) text += gates_text(table);
    return text + exclusion_text(bench.exclusion) + scaling_text(bench.scaling);
}

LogPlot gate_plot(const GateTable& table) {
    LogPlot plot{fmt::format("Equal time, {}, {} bounces", table.scene, table.max_bounces),
                 "gate width [mm]",
                 "relative MSE after 1 s",
                 {}};
    for (const GateBench& gate : table.gates) {
        if (gate.gate_mm == 0.0) continue;
        const auto same =
            std::find_if(plot.lines.begin(), plot.lines.end(), [&](const PlotLine& line) {
                return line.title == gate.method;
            });
        PlotLine& line = same != plot.lines.end()
                             ? *same
                             : plot.lines.emplace_back(PlotLine{gate.method, {}, {}});
        line.x.push_back(gate.gate_mm);
        line.y.push_back(gate.rel_mse);
    }
    return plot;
}

LogPlot scaling_plot(const RenderBench& bench) {
    LogPlot plot{"Scaling", "triangles, wall points, bins, bounces, threads", "time [s]", {}};
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

LogPlot curves_plot(const RenderBench& bench) {
    LogPlot plot{"Error against time, " + bench.scene, "CPU time [s]", "relative L2 error", {}};
    for (const BenchCurve& curve : bench.curves) {
        PlotLine& line = plot.lines.emplace_back();
        line.title = curve.method;
        for (const BenchPoint& point : curve.points) {
            line.x.push_back(point.cpu_seconds);
            line.y.push_back(point.rel_l2);
        }
    }
    PlotLine limit{"path, its rays alone", {}, {}, LineStyle::Limit, 0};
    for (const BenchPoint& point : bench.curves.front().points) {
        limit.x.push_back(bench.ray_limit_seconds * point.samples);
        limit.y.push_back(point.rel_l2);
    }
    const PlotLine front = pareto_front(plot.lines);
    plot.lines.push_back(limit);
    plot.lines.push_back(front);
    return plot;
}

}  // namespace

BenchResult render_result(const RenderBench& bench) {
    BenchResult result{core::write_value(bench), table_of(bench), {}, {}};
    if (!bench.curves.empty()) result.plots[""] = curves_plot(bench);
    if (!bench.scaling.empty()) result.plots["_scaling"] = scaling_plot(bench);
    for (const GateTable& table : bench.gates) {
        const auto scene = std::filesystem::path(table.scene).parent_path().filename();
        result.plots[fmt::format("_gates_{}_{}", scene.string(), table.max_bounces)] =
            gate_plot(table);
    }
    return result;
}

}  // namespace apps
