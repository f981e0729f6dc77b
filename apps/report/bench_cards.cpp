// SPDX-License-Identifier: MIT
#include "apps/report/bench_cards.h"

#include "apps/report/html.h"
#include "apps/report/result_cards.h"

#include <fmt/core.h>

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

std::string stem_of(const std::string& file) {
    return fs::path(file).stem().string();
}

std::string cell_html(const core::Json& row, const char* key) {
    return "<td>" + escape_html(text_of(row, key)) + "</td>";
}

}  // namespace

bool is_bench(const core::Json& json) {
    return json.is_object() && json.contains("program") && json.contains("machine");
}

bool is_collection_of_benches(const core::Json& json) {
    return json.is_object() && !json.empty() && is_bench(json.front());
}

BenchCard read_bench_card(const std::string& path, const core::Json& json) {
    BenchCard card;
    card.file = fs::path(path).filename().string();
    card.facts = {{"Version", text_of(json, "program")},
                  {"Machine", text_of(json, "machine")},
                  {"Libraries", text_of(json, "libraries")}};
    const fs::path table = fs::path(path).replace_extension(".txt");
    if (fs::exists(table)) card.table = read_bytes(table.string());
    return card;
}

void give_figures_to_benches(std::vector<Figure>& figures, std::vector<BenchCard>& benches) {
    std::set<std::string> drawn;  // .svg: these need no .png
    for (const Figure& figure : figures) {
        if (figure.mime_type == "image/svg+xml") drawn.insert(stem_of(figure.file));
    }
    for (BenchCard& card : benches) {
        std::erase_if(figures, [&](Figure& figure) {
            const std::string stem = stem_of(figure.file);
            if (!stem.starts_with(stem_of(card.file))) return false;
            const bool again = figure.mime_type == "image/png" && drawn.contains(stem);
            if (!again) card.figures.push_back(std::move(figure));
            return true;
        });
    }
}

std::string benches_html(const std::vector<BenchCard>& benches) {
    std::string html;
    for (const BenchCard& card : benches) {
        html += fmt::format("<article><h3>{}</h3>\n", escape_html(card.file));
        for (const Figure& figure : card.figures) {
            html += figure_html(embedded_image(figure.bytes, figure.mime_type, figure.file),
                                escape_html(figure.file));
        }
        if (!card.table.empty()) html += "<pre>" + escape_html(card.table) + "</pre>\n";
        html += facts_html(card.facts) + "</article>\n";
    }
    return html;
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
            html += cell_html(row, key);
        }
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

}  // namespace apps
