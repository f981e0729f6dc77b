// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/fit/fit.h"
#include "apps/commands.h"

namespace apps {
namespace {

void declare(CLI::App& command, FitBenchSettings& settings) {
    add_setting(command, "--trials", settings.trials, "Fits per row of the table", {1, 10000});
    command.add_option("--only", settings.parts, "Parts of the table")
        ->check(one_of(fit_bench_parts()));
}

}  // namespace

void add_bench_fit_command(CLI::App& bench) {
    add_benchmark<FitBenchSettings>(bench,
                                    {"fit",
                                     "Fitting and calibration against their targets",
                                     "nlos bench fit -o out/bench --trials 1"},
                                    declare,
                                    measure_fit);
}

}  // namespace apps
