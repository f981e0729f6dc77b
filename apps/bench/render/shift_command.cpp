// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/render/shift.h"
#include "apps/commands.h"

namespace apps {
namespace {

struct ShiftBenchSettings {
    std::vector<std::string> scenes{
        "scenes/corner/scene.json", "scenes/letter/scene.json", "scenes/bars/scene.json"};
    int shifts = 20'000;
};

void declare(CLI::App& command, ShiftBenchSettings& settings) {
    add_setting(command, "--scene", settings.scenes, "Scene descriptions; gauges on the first");
    add_setting(command, "--shifts", settings.shifts, "Shifts per scene", {1, 100'000'000});
}

BenchResult measure(const ShiftBenchSettings& settings, const core::Progress& progress) {
    return {core::write_value(bench_shift(settings.scenes, settings.shifts, progress))};
}

}  // namespace

void add_bench_shift_command(CLI::App& bench) {
    add_benchmark<ShiftBenchSettings>(bench,
                                      {"shift",
                                       "Gauges and charts of the path-length-aware shift",
                                       "nlos bench shift -o out/bench"},
                                      declare,
                                      measure);
}

}  // namespace apps
