// SPDX-License-Identifier: MIT
#include "apps/report/sweep_panels.h"

#include "apps/page/html.h"
#include "apps/report/result_panels.h"
#include "renderer/core/settings/json_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

namespace apps {
namespace {

using core::Json;

constexpr std::size_t kMostRows = 500;

std::string text_of_cell(const Json& value) {
    if (value.is_null()) return "";
    if (value.is_number_float()) return short_number(value.get<double>());
    if (value.is_string()) return value.get<std::string>();
    return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// A column's name; of a setting, its key below the last part of it.
std::string heading(const std::string& column) {
    const std::size_t dot = column.rfind('.');
    if (dot == std::string::npos) return "<th>" + escape_html(column) + "</th>";
    return fmt::format("<th>{}<small>{}</small></th>",
                       escape_html(column.substr(dot + 1)),
                       escape_html(column.substr(0, dot)));
}

std::string cell_of(const Json& row, const std::string& column) {
    const Json value = row.value(column, Json());
    const bool is_setting = column.find('.') != std::string::npos;
    if (value.is_null() && !is_setting) return "<td class=\"none\">&ndash;</td>";
    std::string text = value.is_null() ? "none" : text_of_cell(value);
    if (column == "failed") text = "yes";  // why stands below the table
    return "<td>" + escape_html(text) + "</td>";
}

std::string runs_table(const Json& content) {
    std::string html = "<div class=\"scroll\"><table><thead><tr>";
    for (const Json& column : content["headline"]) html += heading(text_of_cell(column));
    html += "</tr></thead><tbody>\n";
    std::size_t num_rows = 0;
    for (const Json& row : content["runs"]) {
        if (++num_rows > kMostRows) break;
        html += "<tr>";
        for (const Json& column : content["headline"]) html += cell_of(row, text_of_cell(column));
        html += "</tr>\n";
    }
    html += "</tbody></table></div>\n";
    const std::size_t left_out =
        content["runs"].size() - std::min(content["runs"].size(), kMostRows);
    const std::string more = left_out > 0 ? fmt::format("{} more runs and all ", left_out) : "All ";
    return html + "<p class=\"hint\">" + more + "scores stand in sweep.csv.</p>\n";
}

/// Why runs failed, each reason once.
std::string failures_html(const Json& content) {
    std::vector<std::pair<std::string, std::string>> reasons;  // and numbers of runs
    for (const Json& row : content["runs"]) {
        const auto it = row.find("failed");
        if (it == row.end() || !it->is_string()) continue;
        const auto reason = it->get<std::string>();
        const std::string number = text_of_cell(row.value("run", Json()));
        const auto same = std::ranges::find(reasons, reason, &decltype(reasons)::value_type::first);
        if (same == reasons.end()) {
            reasons.emplace_back(reason, number);
        } else {
            same->second += ", " + number;
        }
    }
    std::string html;
    for (const auto& [reason, numbers] : reasons) {
        html += fmt::format(
            "<li><b>Run {}</b> failed: {}</li>", escape_html(numbers), escape_html(reason));
    }
    return html.empty() ? "" : "<ul class=\"errors\">" + html + "</ul>\n";
}

}  // namespace

bool is_sweep(const Json& json) {
    if (!json.is_object() || !json.contains("sweep") || !json["sweep"].is_object()) return false;
    for (const char* key : {"headline", "plots", "runs"}) {
        if (!json.contains(key) || !json[key].is_array()) return false;
    }
    return std::ranges::all_of(json["runs"], [](const Json& row) { return row.is_object(); });
}

void give_figures_to_sweeps(std::vector<Figure>& figures, std::vector<SweepPanel>& sweeps) {
    for (SweepPanel& panel : sweeps) {
        std::set<std::string> stems;
        for (const Json& name : panel.content["plots"]) stems.insert(text_of_cell(name));
        std::erase_if(figures, [&](Figure& figure) {
            const std::filesystem::path file = figure.file;
            if (!stems.contains(file.stem().string())) return false;
            if (file.extension() == ".svg") panel.figures.push_back(std::move(figure));
            return true;
        });
    }
}

std::string sweep_html(const SweepPanel& panel, PagePictures& pictures) {
    std::string html = fmt::format("<article><h3>{}</h3>\n", escape_html(panel.file));
    html += facts_html({{"Scene", text_of_cell(panel.content["sweep"].value("scene", Json()))},
                        {"Runs", fmt::format("{}", panel.content["runs"].size())},
                        {"Failed", text_of_cell(panel.content.value("num_failed", Json(0)))},
                        {"Version", text_of_cell(panel.content.value("program", Json()))}});
    html += "</article>\n" + runs_table(panel.content) + failures_html(panel.content);
    for (const Figure& figure : panel.figures) {
        html += figure_html(pictures.image(figure.bytes, figure.file), escape_html(figure.file));
    }
    return html;
}

}  // namespace apps
