// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench/output.h"
#include "apps/bench/shift.h"
#include "apps/commands.h"

#include <memory>

namespace apps {
namespace {

struct ShiftBenchArguments {
    BenchOutput output;
    std::vector<std::string> scenes{
        "scenes/corner/scene.json", "scenes/letter/scene.json", "scenes/bars/scene.json"};
    int shifts = 20'000;
};

void run(const ShiftBenchArguments& arguments) {
    run_benchmark(arguments.output, "shift", [&](const core::Progress& progress) {
        const ShiftBench bench = bench_shift(arguments.scenes, arguments.shifts, progress);
        return BenchResult{core::write_value(bench), table_of(bench), {}, {}};
    });
}

}  // namespace

void add_shift_bench(CLI::App& bench) {
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
