// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/field/field.h"
#include "apps/commands.h"
#include "apps/outcome.h"
#include "apps/report/report.h"
#include "apps/terminal.h"

#include <filesystem>
#include <memory>
#include <utility>

namespace apps {
namespace {

void run(const BenchOutput& output, const FieldSettings& settings) {
    const std::filesystem::path folder = output.folder;
    run_benchmark(output, "field", [&](const core::Progress& progress) {
        return measure_field(settings, (folder / "files").string(), progress);
    });
    const std::string page = (folder / "report.html").string();
    write_report(page, read_results_folder(output.folder), {});
    note_written({page});
    print("wrote {}\n", page);
}

}  // namespace

void add_bench_field_command(CLI::App& bench) {
    const auto state = std::make_shared<std::pair<BenchOutput, FieldSettings>>();
    FieldSettings& settings = state->second;
    Command& command =
        add_command(bench, "field", "Our methods and installed peers on the same files");
    add_output_options(command, state->first);
    add_setting(command, "--part", settings.part, "What to measure")
        ->check(one_of({"all", "reconstruct", "render", "captures"}));
    command
        .add_option("--peers",
                    settings.peers,
                    "Environment of apps/bench/field/install_peers.sh (default: no peers)")
        ->type_name("DIR");
    command
        .add_option("--captures",
                    settings.captures,
                    "Folder with captures.json: own captures and known distances")
        ->type_name("DIR");
    add_setting(command,
                "--sensing-points",
                settings.sensing_points,
                "Wall points along either side, a multiple of 4",
                {8, 256});
    add_setting(command, "--limit-s", settings.limit_s, "CPU time one run may take [s]");
    command.add_flag("--quick", settings.quick, "The letter alone: a few minutes");
    command.example = "nlos bench field -o out/field --quick --sensing-points 16";
    command.callback([state] { run(state->first, state->second); });
}

}  // namespace apps
