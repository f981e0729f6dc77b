// SPDX-License-Identifier: MIT
#include "apps/sweep/sweep_summary.h"

#include "apps/version.h"
#include "nlos/pictures/picture.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace apps {
namespace {

using core::Json;

/// Of what stands in a row, settings have a dotted key.
bool is_setting(const std::string& column) {
    return column.find('.') != std::string::npos;
}

std::string csv_cell(const Json& value) {
    if (value.is_null()) return "";
    const std::string text = value.is_string()
                                 ? value.get<std::string>()
                                 : value.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string csv_line(const std::vector<std::string>& cells) {
    return fmt::format("{}\r\n", fmt::join(cells, ","));
}

/// All keys of the rows, in the order in which they come.
std::vector<std::string> columns_of(const Json& rows) {
    std::vector<std::string> columns;
    std::set<std::string> known;
    for (const Json& row : rows) {
        for (const auto& [key, value] : row.items()) {
            if (known.insert(key).second) columns.push_back(key);
        }
    }
    return columns;
}

}  // namespace

std::string csv_text(const Json& rows) {
    const std::vector<std::string> columns = columns_of(rows);
    std::vector<std::string> cells;
    for (const std::string& column : columns) cells.push_back(csv_cell(column));
    std::string text = csv_line(cells);
    for (const Json& row : rows) {
        cells.clear();
        for (const std::string& column : columns) {
            cells.push_back(csv_cell(row.value(column, Json(nullptr))));
        }
        text += csv_line(cells);
    }
    return text;
}

Table headline_table(const SweepSettings& sweep, const Json& rows) {
    std::vector<std::string> columns{"run"};
    if (sweep.repeats > 1) columns.emplace_back("repeat");
    for (const SweepAxis& axis : sweep.grid.axes) {
        if (axis.values.size() > 1) {
            columns.insert(columns.end(), axis.keys.begin(), axis.keys.end());
        }
    }
    for (const char* key : {"depth_mae_m",
                            "depth_coverage",
                            "mask_iou_stated",
                            "fscore_10mm",
                            "seconds_render",
                            "seconds_reconstruct",
                            "failed"}) {
        columns.emplace_back(key);
    }
    Json shown = Json::array();
    for (const Json& row : rows) {
        Json& line = shown.emplace_back(Json::object());
        for (const std::string& column : columns) {
            line[column] = row.value(column, Json(nullptr));
            if (is_setting(column) && line[column].is_null()) line[column] = "none";
        }
    }
    const std::vector<Table> tables = tables_of({{"runs", shown}});
    return {"", tables.front().columns, tables.front().rows};
}

SweepSummary write_summary(const SweepPlan& plan, const Json& rows, const std::string& folder) {
    const std::filesystem::path path(folder);
    SweepSummary summary;
    std::set<std::string> programs;
    for (const Json& row : rows) {
        if (!row["failed"].is_null()) ++summary.num_failed;
        programs.insert(row.value("program", ""));
    }
    if (programs.size() > 1) {
        summary.warnings.push_back(fmt::format(
            "the runs are of {} versions of the program, see sweep.csv", programs.size()));
    }
    const std::map<std::string, nlos::Plot> plots = plots_of(plan.settings(), rows);
    Json json;
    json["program"] = version_text();
    json["sweep"] = core::write_value(plan.settings());
    json["sweep"]["scene"] = std::filesystem::path(plan.settings().scene).filename().string();
    json["fingerprint"] = plan.fingerprint();
    json["num_failed"] = summary.num_failed;
    json["plots"] = Json::array();
    for (const auto& [name, plot] : plots) json["plots"].push_back(name);
    const Table headline = headline_table(plan.settings(), rows);
    json["headline"] = headline.columns;
    json["runs"] = rows;
    core::write_text_file((path / "sweep.csv").string(), csv_text(rows));
    for (const auto& [name, plot] : plots) {
        for (const char* format : {".svg", ".png"}) {
            nlos::write_panels((path / (name + format)).string(), {plot}, 1);
        }
    }
    core::write_text_file((path / "sweep.json").string(), core::json_text(json));
    return summary;
}

}  // namespace apps
