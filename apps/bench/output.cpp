// SPDX-License-Identifier: MIT
#include "apps/bench/output.h"

#include "apps/bench/machine.h"
#include "apps/bench/regression.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "renderer/core/output_file.h"

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include <filesystem>

namespace apps {
namespace {

std::string make_stem(const std::string& folder, const std::string& name) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw core::Error(folder, "cannot be made", "must be a writable folder");
    return (std::filesystem::path(folder) / ("bench_" + name)).string();
}

core::Json read_earlier(const std::string& path, const std::string& name) {
    if (path.empty()) return nullptr;
    core::Json json = core::read_json_file(path);
    if (json.contains(name) && json[name].is_object()) json = core::Json(json[name]);
    if (!json.contains("program")) {
        throw core::Error(path, "is not a benchmark's", "must be a bench_*.json of an earlier run");
    }
    return json;
}

bool draw_plots(const BenchResult& result, const std::string& stem) {
    bool drawn = true;
    for (const auto& [suffix, plot] : result.plots) drawn = draw_plot(plot, stem + suffix) && drawn;
    return drawn;
}

}  // namespace

void add_output_options(CLI::App& command, BenchOutput& output) {
    command.add_option("-o,--output", output.folder, "Folder for JSON, table and plots")
        ->required();
    command.add_option("--against",
                       output.against,
                       "JSON of an earlier run: says what got slower or less accurate");
}

core::Json run_benchmark(const BenchOutput& output,
                         const std::string& name,
                         const Benchmark& benchmark) {
    const std::string stem = make_stem(output.folder, name);
    const core::Json earlier = read_earlier(output.against, name);
    ProgressBar bar("bench " + name);
    BenchResult result = benchmark(bar.progress());
    result.figures["program"] = version_text();
    result.figures["machine"] = machine_text();
    result.figures["libraries"] = libraries_text();
    if (!earlier.is_null()) {
        const BenchRegression against = compare_benches(earlier, result.figures);
        result.figures["against"] = core::write_value(against);
        result.table += against_table(against);
    }
    core::write_text_file(stem + ".json", result.figures.dump(2) + "\n");
    core::write_text_file(stem + ".txt", result.table);
    for (const auto& [suffix, bytes] : result.pictures) {
        core::write_text_file(stem + suffix + ".png", bytes);
    }
    if (!draw_plots(result, stem)) {
        fmt::print(stderr, "bench: gnuplot is not there, so no plot was drawn\n");
    }
    fmt::print("{}wrote {}\n", result.table, stem + ".json");
    return result.figures;
}

}  // namespace apps
