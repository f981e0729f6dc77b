// SPDX-License-Identifier: MIT
#include "apps/report/bench_panels.h"

#include "apps/page/html.h"
#include "renderer/core/settings/json_file.h"

#include <fmt/core.h>

#include <charconv>
#include <filesystem>
#include <set>

namespace apps {
namespace {

namespace fs = std::filesystem;

std::string text_of(const core::Json& json, const char* key) {
    const auto it = json.find(key);
    if (it == json.end()) return "";
    if (it->is_number()) return short_number(it->get<double>());
    return it->is_string() ? it->get<std::string>() : it->dump();
}

constexpr std::size_t kLongTable = 60;  // rows, from which on a table is folded

bool is_number(const std::string& text) {
    double value = 0.0;
    const char* end = text.data() + text.size();
    return std::from_chars(text.data(), end, value).ptr == end;
}

std::string table_html(const Table& table) {
    std::vector<bool> holds_words(table.columns.size());
    for (const std::vector<std::string>& row : table.rows) {
        for (std::size_t c = 0; c < row.size(); ++c) {
            if (!row[c].empty() && !is_number(row[c])) holds_words[c] = true;
        }
    }
    const auto row_html = [&](const std::vector<std::string>& cells, const char* element) {
        std::string html = "<tr>";
        for (std::size_t c = 0; c < cells.size(); ++c) {
            html += fmt::format("<{0}{1}>{2}</{0}>",
                                element,
                                holds_words[c] ? " class=\"text\"" : "",
                                escape_html(cells[c]));
        }
        return html + "</tr>\n";
    };
    std::string html =
        "<div class=\"bench\"><table><thead>" + row_html(table.columns, "th") + "</thead><tbody>\n";
    for (const std::vector<std::string>& row : table.rows) html += row_html(row, "td");
    html += "</tbody></table></div>\n";
    const std::string name = escape_html(table.name);
    if (table.rows.size() < kLongTable) return (name.empty() ? "" : "<h4>" + name + "</h4>") + html;
    return fmt::format(
        "<details><summary>{}, {} rows</summary>{}</details>\n", name, table.rows.size(), html);
}

// The tables of a benchmark, behind them what changed against an earlier run.
std::vector<Table> all_tables(core::Json figures) {
    const core::Json against = figures.value("against", core::Json::object());
    for (const char* key : {"program", "machine", "libraries", "against"}) figures.erase(key);
    std::vector<Table> tables = tables_of(figures);
    for (Table& table : tables_of(against)) tables.push_back(std::move(table));
    return tables;
}

std::string stem_of(const std::string& file) {
    return fs::path(file).stem().string();
}

}  // namespace

bool is_bench(const core::Json& json) {
    return json.is_object() && json.contains("program") && json.contains("machine");
}

bool is_collection_of_benches(const core::Json& json) {
    return json.is_object() && !json.empty() && is_bench(json.front());
}

BenchPanel read_bench_panel(const std::string& path, const core::Json& json) {
    BenchPanel panel;
    panel.file = shown_file(path);
    panel.facts = {{"Version", text_of(json, "program")},
                   {"Machine", text_of(json, "machine")},
                   {"Libraries", text_of(json, "libraries")}};
    panel.tables = all_tables(json);
    return panel;
}

void give_figures_to_benches(std::vector<Figure>& figures, std::vector<BenchPanel>& benches) {
    std::set<std::string> drawn;  // .svg: these need no .png
    for (const Figure& figure : figures) {
        if (figure.file.ends_with(".svg")) drawn.insert(stem_of(figure.file));
    }
    for (BenchPanel& panel : benches) {
        std::erase_if(figures, [&](Figure& figure) {
            const std::string stem = stem_of(figure.file);
            if (!stem.starts_with(stem_of(panel.file))) return false;
            const bool again = figure.file.ends_with(".png") && drawn.contains(stem);
            if (!again) panel.figures.push_back(std::move(figure));
            return true;
        });
    }
}

std::string bench_html(const BenchPanel& panel, PagePictures& pictures) {
    std::string html = fmt::format("<article><h3>{}</h3>\n", escape_html(panel.file));
    const auto add_tables = [&](bool are_long) {
        for (const Table& table : panel.tables) {
            if ((table.rows.size() >= kLongTable) == are_long) html += table_html(table);
        }
    };
    add_tables(false);
    for (const Figure& figure : panel.figures) {
        html += figure_html(pictures.image(figure.bytes, figure.file), escape_html(figure.file));
    }
    add_tables(true);
    return html + facts_html(panel.facts) + "</article>\n";
}

std::string hard_cases_html(const core::Json& cases) {
    if (!cases.is_array() || cases.empty()) return "";
    std::string html =
        "<div class=\"scroll\"><table class=\"words\"><thead><tr><th>Case</th><th>Why it is "
        "hard</th>"
        "<th>What must hold</th><th>Worst</th><th>Bound</th><th>Explanation</th></tr></thead>"
        "<tbody>\n";
    for (const core::Json& row : cases) {
        if (!row.is_object()) continue;
        html += fmt::format("<tr><th>{}: {}</th>",
                            escape_html(text_of(row, "group")),
                            escape_html(text_of(row, "name")));
        for (const char* key : {"why", "must_hold", "worst", "bound", "explanation"}) {
            html += "<td>" + escape_html(text_of(row, key)) + "</td>";
        }
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

}  // namespace apps
