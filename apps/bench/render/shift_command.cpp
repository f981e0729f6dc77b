// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench/output.h"
#include "apps/bench/render/shift.h"
#include "apps/commands.h"

#include <fmt/core.h>

#include <memory>

namespace apps {
namespace {

struct ShiftBenchArguments {
    BenchOutput output;
    std::vector<std::string> scenes{
        "scenes/corner/scene.json", "scenes/letter/scene.json", "scenes/bars/scene.json"};
    int shifts = 20'000;
};

std::string table_of(const ShiftBench& bench) {
    std::string text =
        fmt::format("gauges on {}\n{:<11} {:<16} {:>8} {:>10} {:>6} {:>8} {:>8} {:>9} {:>9}\n",
                    bench.gauge_scene,
                    "chart",
                    "gauge",
                    "success",
                    "no return",
                    "steps",
                    "ns",
                    "checked",
                    "det. err",
                    "95 %");
    for (const GaugeRow& row : bench.gauges) {
        text += fmt::format(
            "{:<11} {:<16} {:>7.2f}% {:>9.3f}% {:>6.2f} {:>8.0f} {:>8.0f} {:>9.1e} {:>9.1e}\n",
            row.chart,
            row.gauge,
            100.0 * row.success,
            100.0 * row.no_return,
            row.iterations,
            row.ns,
            row.ns_checked,
            row.error_median,
            row.error_p95);
    }
    text += fmt::format("\n{:<26} {:<11} {:>8} {:>8} {:>8}  rejected\n",
                        "scene",
                        "chart",
                        "accepted",
                        "by ray",
                        "ns");
    for (const ChartRow& row : bench.charts) {
        text += fmt::format("{:<26} {:<11} {:>7.2f}% {:>7.2f}% {:>8.0f} ",
                            row.scene,
                            row.chart,
                            100.0 * row.accepted,
                            100.0 * row.by_ray,
                            row.ns);
        for (const ShiftShare& share : row.rejected) {
            text += fmt::format(" {} {:.2f}%", share.name, 100.0 * share.share);
        }
        text += "\n";
    }
    text += fmt::format("\n{:<40} {:>8}\n", "part of a shift", "ns");
    for (const ShiftCost& cost : bench.costs) {
        text += fmt::format("{:<40} {:>8.0f}\n", cost.operation, cost.ns);
    }
    return text;
}

void run(const ShiftBenchArguments& arguments) {
    run_benchmark(arguments.output, "shift", [&](const core::Progress& progress) {
        const ShiftBench bench = bench_shift(arguments.scenes, arguments.shifts, progress);
        return BenchResult{core::write_value(bench), table_of(bench), {}, {}};
    });
}

}  // namespace

void add_bench_shift_command(CLI::App& bench) {
    const auto arguments = std::make_shared<ShiftBenchArguments>();
    CLI::App* shift =
        bench.add_subcommand("shift", "Gauges and charts of the path-length-aware shift");
    add_output_options(*shift, arguments->output);
    shift->add_option("--scene", arguments->scenes, "Scene descriptions; gauges on the first")
        ->capture_default_str();
    shift->add_option("--shifts", arguments->shifts, "Shifts per scene")
        ->capture_default_str()
        ->check(CLI::Range(1, 100'000'000));
    shift->footer(settings_footer({}, "nlos bench shift -o out/bench"));
    shift->callback([arguments] { run(*arguments); });
}

}  // namespace apps
