// SPDX-License-Identifier: MIT
#include "apps/bench_output.h"

#include "apps/version.h"
#include "renderer/core/output_file.h"

#include <fmt/core.h>

#include <filesystem>

namespace apps {

std::string result_stem(const std::string& folder, const std::string& name) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw core::Error(folder, "cannot be made", "must be a writable folder");
    return (std::filesystem::path(folder) / name).string();
}

void write_tables(const std::string& stem, core::Json json, const std::string& table) {
    json["program"] = version_text();
    core::write_text_file(stem + ".json", json.dump(2) + "\n");
    core::write_text_file(stem + ".txt", table);
    fmt::print("{}", table);
}

void report_results(const std::string& stem, bool has_plots) {
    if (!has_plots) {
        fmt::print(stderr, "bench: gnuplot is not there, so no plot was drawn\n");
    }
    fmt::print("wrote {}\n", stem + ".json");
}

}  // namespace apps
