// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench/fit/fit.h"
#include "apps/commands.h"

#include <fmt/core.h>

#include <memory>

namespace apps {
namespace {

struct BenchFitArguments {
    BenchOutput output;
    int trials = 30;
    std::vector<std::string> parts;
};

std::string table_of(const FitBench& bench) {
    std::string text = fmt::format("{:<80} {:<38} {:<46} met\n", "fit", "target", "ours");
    for (const FitBenchRow& row : bench.rows) {
        text += fmt::format(
            "{:<80} {:<38} {:<46} {}\n", row.name, row.target, row.ours, row.holds ? "yes" : "no");
    }
    text += fmt::format("\n{:<20} {:>8} {:>12} {:>14} {:>14}\n",
                        "choice",
                        "CPU s",
                        "iterations",
                        "position [mm]",
                        "turn [deg]");
    for (const FitBenchPoint& point : bench.points) {
        text += fmt::format("{:<20} {:>8.2f} {:>12.1f} {:>14.3f} {:>14.3f}\n",
                            point.choice,
                            point.cpu_seconds,
                            point.iterations,
                            1e3 * point.position_rms_m,
                            point.rotation_rms_deg);
    }
    return text;
}

}  // namespace

BenchResult fit_result(const FitBench& bench) {
    BenchResult result{core::write_value(bench), table_of(bench), {}, {}};
    if (bench.points.empty()) return result;
    LogPlot plot{"Error against time of fits", "CPU time [s]", "position error [m]", {}};
    for (const FitBenchPoint& point : bench.points) {
        plot.lines.push_back({point.choice, {point.cpu_seconds}, {point.position_rms_m}});
    }
    plot.lines.push_back(pareto_front(plot.lines));
    result.plots[""] = plot;
    return result;
}

void add_bench_fit_command(CLI::App& bench) {
    const auto arguments = std::make_shared<BenchFitArguments>();
    CLI::App* command =
        bench.add_subcommand("fit", "Fitting and calibration against their targets");
    add_output_options(*command, arguments->output);
    command->add_option("--trials", arguments->trials, "Fits per row of the table")
        ->capture_default_str()
        ->check(CLI::Range(1, 10000));
    command->add_option("--only", arguments->parts, "Parts of the table")
        ->check(CLI::IsMember(fit_bench_parts()));
    command->footer(settings_footer({}, "nlos bench fit -o out/bench --trials 1"));
    command->callback([arguments] {
        run_benchmark(arguments->output, "fit", [&](const core::Progress& progress) {
            return fit_result(bench_fit(arguments->trials, arguments->parts, progress));
        });
    });
}

}  // namespace apps
