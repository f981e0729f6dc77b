// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/gnuplot.h"
#include "renderer/core/progress.h"
#include "renderer/core/settings.h"

#include <functional>
#include <map>
#include <string>

namespace CLI {
class App;
}

namespace apps {

/// Where a benchmark writes and what it is held against.
struct BenchOutput {
    std::string folder;
    std::string against;  ///< JSON file of an earlier run; empty: none
};

/// Declares -o and --against.
void add_output_options(CLI::App& command, BenchOutput& output);

/// What a benchmark found.
struct BenchResult {
    core::Json figures;
    std::string table;                            ///< for people
    std::map<std::string, LogPlot> plots;         ///< by the end of their file's name
    std::map<std::string, std::string> pictures;  ///< bytes of PNG files, likewise
};

using Benchmark = std::function<BenchResult(const core::Progress&)>;

/// Runs a benchmark and writes bench_NAME.json (with version and machine), bench_NAME.txt, and
/// plots as .svg and .png beside them; prints the table.
///
/// name      of the benchmark; an earlier run is found under this name in files of `bench all`
/// returns   the JSON that was written
/// throws    core::Error, before anything is measured, for a folder that cannot be made or an
///           earlier run that cannot be read
core::Json run_benchmark(const BenchOutput& output,
                         const std::string& name,
                         const Benchmark& benchmark);

}  // namespace apps
