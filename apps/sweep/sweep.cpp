// SPDX-License-Identifier: MIT
#include "apps/sweep/sweep.h"

#include "apps/version.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"

#include <fmt/core.h>

#include <filesystem>
#include <utility>
#include <vector>

namespace apps {
namespace fs = std::filesystem;

SweepResults::SweepResults(const SweepPlan& plan, std::string folder)
    : plan_(plan), folder_((fs::path(std::move(folder)) / "runs").string()) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) {
        throw core::Error(
            folder_, "cannot be made (" + error.message() + ")", "must be in a writable folder");
    }
}

std::string SweepResults::path_of(std::size_t run) const {
    return (fs::path(folder_) / fmt::format("{:06}.json", run)).string();
}

void SweepResults::write(const SweepRun& run, const SweepResult& result) const {
    core::Json json;
    json["run"] = run.number;
    json["repeat"] = run.repeat;
    json["values"] = run.values;
    json.update(core::write_value(result));
    json["program"] = version_text();
    json["fingerprint"] = plan_.fingerprint();
    core::write_text_file(path_of(run.number), core::json_text(json));
}

std::optional<core::Json> SweepResults::read(std::size_t run) const {
    const std::string path = path_of(run);
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return std::nullopt;
    core::Json json;
    try {
        json = core::read_json_file(path);
    } catch (const core::Error&) {
        return std::nullopt;
    }
    const auto holds = [&](const char* key) { return json.contains(key) && json[key].is_object(); };
    if (!json.is_object() || !json.contains("fingerprint")) return std::nullopt;
    if (json["fingerprint"] != plan_.fingerprint()) {
        throw core::Error(path,
                          "found the result of another sweep, or of other content of its files",
                          "must be of this one: take another folder, or remove this one");
    }
    if (!holds("values") || !holds("metrics")) return std::nullopt;
    return json;
}

std::size_t SweepResults::num_done() const {
    std::size_t count = 0;
    for (std::size_t run = 0; run < plan_.num_runs(); ++run) count += has(run) ? 1U : 0U;
    return count;
}

std::optional<core::Json> SweepResults::rows() const {
    core::Json rows = core::Json::array();
    for (std::size_t run = 0; run < plan_.num_runs(); ++run) {
        std::optional<core::Json> result = read(run);
        if (!result) return std::nullopt;
        core::Json row = {{"run", run}};
        if (plan_.settings().repeats > 1) row["repeat"] = (*result)["repeat"];
        row.update((*result)["values"]);
        for (const char* key : {"run", "repeat", "values", "fingerprint"}) result->erase(key);
        for (const auto& [name, score] : (*result)["metrics"].items()) {
            if (!nlos::looks_at_truth(name)) row[name] = score;
        }
        result->erase("metrics");
        row.update(*result);
        rows.push_back(std::move(row));
    }
    return rows;
}

SweepProgress do_share(const SweepPlan& plan,
                       const SweepResults& results,
                       const WorkShare& share,
                       const core::Progress& progress) {
    SweepProgress done;
    std::vector<std::size_t> left;
    const auto pieces = plan.pieces(share.count);
    for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
        if (!share.takes(piece)) continue;
        for (const std::size_t run : pieces[piece]) {
            if (results.has(run)) {
                ++done.num_kept;
            } else {
                left.push_back(run);
            }
        }
    }
    SweepRunner runner;
    for (const std::size_t number : left) {
        const auto report = [&](double part) {
            progress.update(
                (static_cast<double>(done.num_new) + part) / static_cast<double>(left.size()),
                fmt::format("{} of {} runs", done.num_new, left.size()));
        };
        core::Progress of_run = progress;
        of_run.report = [&](double part, const std::string&) { report(part); };
        const SweepRun run = plan.run(number);
        const std::optional<SweepResult> result = runner.do_run(run, of_run);
        done.interrupted = !result;
        if (!result) break;
        results.write(run, *result);
        ++done.num_new;
        report(0.0);
    }
    return done;
}

}  // namespace apps
