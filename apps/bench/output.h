// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/pictures/panel.h"
#include "nlos/plots/plot.h"
#include "renderer/core/progress.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/settings/settings.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

/// Lists the fields of a benchmark's row, once, under their own names: core::write_value() makes
/// JSON of them, and tables.h makes tables of that. Stands after the struct, in its namespace.
/// What each field means stands beside the field. Rows that only tables read are JSON at once.
#define NLOS_FIGURES(Row, ...)                                              \
    template <class Visitor>                                                \
    void for_each_field(Row& row, Visitor&& visit) {                        \
        NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(NLOS_FIGURE, __VA_ARGS__)) \
    }                                                                       \
    static_assert(true) /* takes the semicolon */
#define NLOS_FIGURE(field) visit(#field, row.field, "");

namespace apps {

/// Where a benchmark writes and what it is held against.
struct BenchOutput {
    std::string folder;
    std::string against;  ///< JSON file of an earlier run; empty: none
    std::string results;  ///< Markdown file to write the figures into; empty: none
};

/// What was asked of a figure, and what came out.
struct Target {
    std::string name;    ///< what was measured
    std::string target;  ///< what was asked
    std::string ours;    ///< what came out
    bool holds = false;  ///< whether the target is met
};
NLOS_FIGURES(Target, name, target, ours, holds);

/// Panels in rows of `columns`.
struct BenchPicture {
    std::vector<nlos::Panel> panels;
    int columns = 1;
};

/// What a benchmark found.
struct BenchResult {
    core::Json figures;                              ///< an object; tables.h makes tables of it
    std::map<std::string, nlos::Plot> plots{};       ///< by the end of their file's name
    std::map<std::string, BenchPicture> pictures{};  ///< likewise
};

/// Measures, and says so by update() before every measurement, which ends the benchmark by
/// core::Failure once the user has asked to stop.
using Benchmark = std::function<BenchResult(const core::Progress&)>;

/// The fraction that a part is of the whole.
template <class Part, class Whole>
double fraction_of(Part part, Whole whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
}

/// The figures of an earlier run of a benchmark; null for an empty path.
///
/// path      its bench_NAME.json, or one of `bench all`, which has them under `name`
/// throws    core::Error when there are none
core::Json read_earlier_run(const std::string& path, const std::string& name);

/// Runs a benchmark and writes bench_NAME.json (with version and machine), bench_NAME.txt, and
/// plots and pictures as .svg and .png beside them; prints the tables. With `results`, the tables
/// also replace the benchmark's section of that Markdown file, or are appended to it; the rest
/// stays.
///
/// name      of the benchmark; an earlier run is found under this name in files of `bench all`
/// returns   the JSON that was written
/// throws    core::Error, before anything is measured, for a folder that cannot be made or an
///           earlier run that cannot be read
core::Json run_benchmark(const BenchOutput& output,
                         const std::string& name,
                         const Benchmark& benchmark);

/// A Markdown text with the section of one benchmark replaced, or appended when it has none. The
/// section stands between `<!-- nlos bench NAME -->` and `<!-- end of nlos bench NAME -->`.
std::string with_section(const std::string& text,
                         const std::string& name,
                         const std::string& section);

}  // namespace apps
