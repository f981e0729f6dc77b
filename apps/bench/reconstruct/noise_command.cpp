// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/reconstruct/noise.h"
#include "apps/commands.h"

namespace apps {
namespace {

void declare(CLI::App& command, NoiseBenchSettings& settings) {
    add_setting(command, "--scene", settings.scene, "Scene description")->type_name("FILE");
    add_setting(command, "--repeats", settings.repeats, "Seeds per figure", {1, 1000});
}

}  // namespace

void add_bench_noise_command(CLI::App& bench) {
    add_benchmark<NoiseBenchSettings>(bench,
                                      {"noise",
                                       "Every reconstruction method against the number of photons",
                                       "nlos bench noise -o out/bench"},
                                      declare,
                                      measure_noise);
}

}  // namespace apps
