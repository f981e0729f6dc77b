// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/commands.h"

namespace apps {
namespace {

void declare(CLI::App& command, ReconstructBenchSettings& settings) {
    add_setting(command, "--scenes", settings.scenes_folder, "Folder of the scenes")
        ->type_name("DIR");
    add_file_option(
        command, "--capture", settings.capture, "Also score this capture of the letter T");
    add_setting(command, "--part", settings.part, "What to measure")
        ->check(one_of({"all", "time", "accuracy", "scaling"}));
    add_setting(command, "--repeats", settings.repeats, "Runs per median", {1, 1000});
    add_threads_option(command, settings.threads);
    add_setting(
        command, "--largest", settings.largest, "Largest side of the scaling curves", {32, 256});
}

}  // namespace

void add_bench_reconstruct_command(CLI::App& bench) {
    add_benchmark<ReconstructBenchSettings>(bench,
                                            {"reconstruct",
                                             "Time, memory and accuracy of every method",
                                             "nlos bench reconstruct -o out/bench"},
                                            declare,
                                            measure_reconstruct);
}

}  // namespace apps
