// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/reconstruct/coverage.h"
#include "apps/commands.h"

namespace apps {
namespace {

void declare_coverage(CLI::App& command, CoverageBenchSettings& settings) {
    add_setting(command, "--surfaces", settings.surfaces, "Random surfaces", {1, 10000});
    add_setting(command, "--first", settings.first, "Number of the first of them", {0, 1000000});
    add_setting(command, "--methods", settings.methods, "Methods, each with its own settings");
    add_setting(command, "--peaks", settings.peaks, "Counts in the brightest bin");
}

}  // namespace

void add_bench_coverage_command(CLI::App& bench) {
    add_benchmark<CoverageBenchSettings>(
        bench,
        {"coverage",
         "Whether stated deviations of depth and probabilities of surfaces hold",
         "nlos bench coverage -o out/bench --surfaces 1 --methods lct --peaks 100"},
        declare_coverage,
        measure_coverage);
}

}  // namespace apps
