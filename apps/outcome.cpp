// SPDX-License-Identifier: MIT
#include "apps/outcome.h"

#include "apps/terminal.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/stopwatch.h"
#include "renderer/core/system/process.h"

#include <algorithm>

namespace apps {
namespace {

const core::Stopwatch g_watch;  // since the program began

}  // namespace

core::Json& outcome() {
    static core::Json fields = core::Json::object();
    return fields;
}

std::string note_written(const std::vector<std::string>& paths) {
    std::string names;
    for (const std::string& path : paths) {
        if (path.empty()) continue;
        outcome()["written"].push_back(core::printable(path));
        names += (names.empty() ? "" : ", ") + path;
    }
    return names;
}

void print_written(const std::vector<std::string>& paths) {
    note_written(paths);
    for (const std::string& path : paths) {
        if (!path.empty()) print("wrote {}\n", path);
    }
}

void print_notes(std::string label, const std::vector<std::string>& notes) {
    for (const std::string& note : notes) print("{}: {}\n", label, note);
    std::ranges::replace(label, ' ', '_');
    for (const std::string& note : notes) outcome()[label].push_back(core::printable(note));
}

void warn(const std::string& text) {
    print_error("warning: {}\n", text);
    outcome()["warnings"].push_back(core::printable(text));
}

void print_outcome(const std::string& command, int status, const std::string& error) noexcept try {
    if (!output_settings().json) return;
    core::Json line{{"command", command}, {"status", status}};
    if (!error.empty()) line["error"] = core::printable(error);
    line["seconds"] = g_watch.seconds();
    line["peak_rss_bytes"] = core::peak_rss_bytes();
    line.update(outcome());
    write_output(line.dump(-1, ' ', false, core::Json::error_handler_t::replace) + "\n");
} catch (const std::exception&) {
    // What failed before has been said; flush_output() says when standard output cannot be written.
}

}  // namespace apps
