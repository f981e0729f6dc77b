// SPDX-License-Identifier: MIT
#include "apps/bench/field/baselines.h"

#include "apps/run_program.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/data_folder.h"
#include "renderer/core/system/output_file.h"
#include "renderer/core/system/process.h"

#include <fmt/core.h>

#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;

constexpr double kPeerFraction = 0.8;  // of the memory that the machine can give

double number_at(const core::Json& json, const char* key) {
    const auto it = json.find(key);
    return it != json.end() && it->is_number() ? it->get<double>() : 0.0;
}

}  // namespace

Baselines::Baselines(const std::string& peers, std::string folder, double limit_s)
    : program_(program_beside("nlos")), folder_(std::move(folder)), limit_s_(limit_s) {
    if (peers.empty()) return;
    python_ = (fs::path(peers) / "bin" / "python").string();
    if (!fs::exists(python_)) {
        throw core::Error("--peers",
                          "found no bin/python in '" + peers + "'",
                          "must be a folder that apps/bench/field/install_peers.sh made");
    }
}

FieldRun Baselines::run(const std::string& kind,
                        const std::vector<std::string>& arguments,
                        const ProcessLimits& limits) {
    FieldRun result;
    if (const auto it = given_up_.find(kind); it != given_up_.end()) {
        result.failure = it->second;
        return result;
    }
    const std::string log = fmt::format("{}/{:03}.log", folder_, num_runs_++);
    const MeasuredProcess process = run_measured(arguments, log, limits);
    result.failure = process.failure;
    result.process_cpu_s = process.cpu_seconds;
    if (process.was_stopped) given_up_[kind] = "not tried again: " + process.failure;
    if (!result.failure.empty()) return result;
    result.said = core::Json::parse(process.last_line, nullptr, false);
    if (!result.said.is_object()) {
        result.failure = "said nothing of what it did";
        result.said = nullptr;
        return result;
    }
    // What the system counts for a child begins with its parent's memory.
    result.peak_bytes = static_cast<std::uint64_t>(number_at(result.said, "peak_rss_bytes"));
    return result;
}

FieldRun Baselines::run_own(const std::string& kind, std::vector<std::string> arguments) {
    const std::string command = arguments.front();
    arguments.insert(arguments.begin(), program_);
    for (const char* option : {"--threads", "1", "--json"}) arguments.emplace_back(option);
    FieldRun result = run("nlos " + kind, arguments, {limit_s_});
    if (!result.failure.empty()) return result;
    // On one thread, fractions of time are fractions of CPU time.
    const double whole_s = number_at(result.said, "seconds");
    const double work_s = number_at(result.said, ("seconds_" + command).c_str());
    result.work_cpu_s = whole_s > 0.0 ? result.process_cpu_s * work_s / whole_s : 0.0;
    return result;
}

FieldRun Baselines::run_peer(const std::string& kind,
                             const std::string& adapter,
                             const core::Json& request) {
    if (python_.empty()) return {.failure = "no environment of peers was given (--peers)"};
    const std::string name = "apps/bench/field/peers/" + adapter + ".py";
    const std::string file = fmt::format("{}/{:03}.request.json", folder_, num_runs_);
    core::write_text_file(file, core::json_text(request));
    // A peer that takes all memory would take this program with it.
    const double most_bytes = kPeerFraction * static_cast<double>(core::available_memory_bytes());
    FieldRun result = run(adapter + " " + kind,
                          {python_, core::shipped_file(name), file},
                          {limit_s_, static_cast<std::uint64_t>(most_bytes)});
    if (!result.failure.empty()) return result;
    const auto version = result.said.find("version");
    if (version != result.said.end() && version->is_string()) versions_.insert(*version);
    result.work_cpu_s = number_at(result.said, "work_cpu_s");
    return result;
}

}  // namespace apps
