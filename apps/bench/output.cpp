// SPDX-License-Identifier: MIT
#include "apps/bench/output.h"

#include "apps/arguments.h"
#include "apps/bench/regression.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/tables/tables.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "nlos/pictures/picture.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
#include "renderer/core/system/parallel.h"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

namespace apps {
namespace {

// The first value of a `name : value` line of a file of the system.
std::string value_in(const std::string& path, const std::string& name) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with(name)) continue;
        const auto start = line.find_first_not_of(" \t", line.find(':') + 1);
        return start == std::string::npos ? "" : line.substr(start);
    }
    return "";
}

/// The processor, how many of it this process may use, and memory, in words.
std::string machine_text() {
    const std::string processor = value_in("/proc/cpuinfo", "model name");
    return fmt::format("{}, {} of its threads, memory {}",
                       processor.empty() ? "unknown processor" : processor,
                       core::thread_count(),
                       value_in("/proc/meminfo", "MemTotal"));
}

/// Compiler and libraries that decide speed, with versions.
std::string libraries_text() {
    return "GCC " __VERSION__ NLOS_LIBRARIES;
}

std::string make_stem(const std::string& folder, const std::string& name) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw core::Error(folder, "cannot be made", "must be a writable folder");
    return (std::filesystem::path(folder) / ("bench_" + name)).string();
}

std::string text_of_file(const std::string& path) {
    if (!std::filesystem::exists(path)) return "";
    return std::string(core::MappedFile(path, "must be a Markdown file").bytes());
}

core::Progress stopping_progress(core::Progress progress, const std::string& name) {
    progress.report = [report = progress.report, name](double fraction, const std::string& detail) {
        if (interrupt_requested()) throw core::Failure("bench " + name, "interrupted");
        report(fraction, detail);
    };
    return progress;
}

void write_results(const BenchOutput& output, const std::string& name, core::Json figures) {
    constexpr std::size_t kMaxRows = 80;
    for (const char* key : {"program", "machine", "libraries", "against"}) figures.erase(key);
    const std::string section =
        fmt::format("## nlos bench {}\n\n{:%Y-%m-%d}, {}, {}; {}\n\n    {}\n\n{}",
                    name,
                    fmt::gmtime(std::time(nullptr)),
                    version_text(),
                    machine_text(),
                    libraries_text(),
                    command_line(),
                    markdown(tables_of(figures), kMaxRows));
    core::write_text_file(output.results,
                          with_section(text_of_file(output.results), name, section));
}

}  // namespace

std::string with_section(const std::string& text,
                         const std::string& name,
                         const std::string& section) {
    const std::string begin = fmt::format("<!-- nlos bench {} -->\n", name);
    const std::string end = fmt::format("<!-- end of nlos bench {} -->\n", name);
    const std::string marked = begin + section + end;
    const std::size_t first = text.find(begin);
    const std::size_t last = text.find(end, first);
    if (first == std::string::npos || last == std::string::npos) {
        return text + (text.empty() ? "" : "\n") + marked;
    }
    return text.substr(0, first) + marked + text.substr(last + end.size());
}

core::Json read_earlier_run(const std::string& path, const std::string& name) {
    if (path.empty()) return nullptr;
    core::Json json = core::read_json_file(path);
    if (json.contains(name) && json[name].is_object()) json = core::Json(json[name]);
    const auto is_text = [&](const char* key) {
        return json.contains(key) && json[key].is_string();
    };
    if (!is_text("program") || !is_text("machine")) {
        throw core::Error(path, "is not a benchmark's", "must be a bench_*.json of an earlier run");
    }
    return json;
}

core::Json run_benchmark(const BenchOutput& output,
                         const std::string& name,
                         const Benchmark& benchmark) {
    const std::string stem = make_stem(output.folder, name);
    core::check_targets({stem + ".json", stem + ".txt", output.results}, {});
    const core::Json earlier = read_earlier_run(output.against, name);
    ProgressBar bar("bench " + name);
    const core::Progress progress = stopping_progress(bar.progress(), name);
    BenchResult result = [&] {
        const StoppableWork stoppable(
            "stopping after this measurement, without a file; Ctrl-C again ends at once");
        return benchmark(progress);
    }();
    if (interrupt_requested()) throw core::Failure("bench " + name, "interrupted");
    std::string table = plain_text(tables_of(result.figures));
    result.figures["program"] = version_text();
    result.figures["machine"] = machine_text();
    result.figures["libraries"] = libraries_text();
    if (!earlier.is_null()) {
        const BenchRegression against = compare_benches(earlier, result.figures);
        result.figures["against"] = core::write_value(against);
        table += plain_text(tables_of(result.figures["against"]));
    }
    core::write_text_file(stem + ".json", core::json_text(result.figures));
    core::write_text_file(stem + ".txt", table);
    if (!output.results.empty()) write_results(output, name, result.figures);
    for (const char* format : {".svg", ".png"}) {
        for (const auto& [suffix, picture] : result.pictures) {
            nlos::write_panels(stem + suffix + format, picture.panels, picture.columns);
        }
        for (const auto& [suffix, plot] : result.plots) {
            nlos::write_panels(stem + suffix + format, {plot}, 1);
        }
    }
    write_message(table);
    note_written({stem + ".json", stem + ".txt", output.results});
    print("wrote {}\n", stem + ".json");
    return result.figures;
}

}  // namespace apps
