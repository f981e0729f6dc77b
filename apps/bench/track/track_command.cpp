// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/track/track.h"
#include "apps/commands.h"

namespace apps {
namespace {

void declare_track(CLI::App& command, TrackBenchSettings& settings) {
    add_setting(command, "--walks", settings.walks, "Trajectories of each row", {1, 10000});
    add_setting(
        command, "--empty-walks", settings.empty_walks, "Scenes without a target", {1, 10000});
    add_setting(command,
                "--systematic-m",
                settings.systematic_m,
                "Error of the model stated beside those of counting [m]");
}

}  // namespace

void add_bench_track_command(CLI::App& bench) {
    add_benchmark<TrackBenchSettings>(bench,
                                      {"track",
                                       "Tracking with a cheap sensor against its targets",
                                       "nlos bench track -o out/bench --walks 2 --empty-walks 1"},
                                      declare_track,
                                      measure_track);
}

}  // namespace apps
