// SPDX-License-Identifier: MIT
#include "apps/report/report.h"

#include "apps/report/bench_cards.h"
#include "apps/report/html.h"
#include "apps/report/metrics_table.h"
#include "apps/version.h"
#include "renderer/core/output_file.h"

#include <fmt/core.h>

#include <algorithm>

namespace apps {

/// report.css, compiled in.
extern const char* const kReportStyle;

namespace {

constexpr const char* kPng = "image/png";

std::string details_html(const std::string& title, const core::Json& json) {
    if (json.is_null()) return "";
    return fmt::format("<details><summary>{}</summary><pre>{}</pre></details>\n",
                       escape_html(title),
                       escape_html(json.dump(2, ' ', false, core::Json::error_handler_t::replace)));
}

std::string notes_html(const std::vector<std::string>& notes) {
    if (notes.empty()) return "";
    std::string html = "<ul class=\"notes\">";
    for (const std::string& note : notes) html += "<li>" + escape_html(note) + "</li>";
    return html + "</ul>\n";
}

std::string card_html(const ResultCard& card, const std::string& picture_of) {
    std::string picture;
    if (!card.picture_png.empty()) {
        picture = "<figure>" +
                  embedded_image(card.picture_png, kPng, picture_of + " of " + card.file) +
                  "</figure>\n";
    }
    return fmt::format("<article><h3>{}</h3>\n", escape_html(card.file)) + picture +
           facts_html(card.facts) + notes_html(card.notes) +
           details_html("Settings and provenance", card.settings) + "</article>\n";
}

/// A section with an anchor; nothing when it has no content.
std::string section_html(const std::string& anchor,
                         const std::string& title,
                         const std::string& content) {
    if (content.empty()) return "";
    return fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", anchor, title, content);
}

std::string scores_html(const std::vector<ScoredResult>& scores) {
    std::string html;
    for (const std::vector<ScoredResult>& group : groups_by_threshold(scores)) {
        html += metrics_tiles(group) + metrics_table(group);
        if (group.size() > 1) {
            html +=
                "<p class=\"hint\">The best value of a row is marked where results can be "
                "compared by it.</p>\n";
        }
    }
    return html;
}

std::string comparisons_html(const std::vector<ScoredResult>& scores) {
    std::string html;
    for (const ScoredResult& scored : scores) {
        if (scored.picture_png.empty()) continue;
        std::string caption = "<b>" + escape_html(scored.name) + "</b>";
        if (!scored.result.empty()) {
            caption += fmt::format(
                ": {} against {}", escape_html(scored.result), escape_html(scored.reference));
        }
        html += figure_html(embedded_image(scored.picture_png, kPng, "Comparison with the truth"),
                            caption);
    }
    return html;
}

std::string cards_html(const std::vector<ResultCard>& cards, const std::string& picture_of) {
    std::string html;
    for (const ResultCard& card : cards) html += card_html(card, picture_of);
    return html;
}

std::string dataset_html(const std::optional<DatasetCard>& dataset) {
    if (!dataset) return "";
    std::string html = card_html(dataset->card, "First items");
    if (!dataset->histograms_png.empty()) {
        html += figure_html(embedded_image(dataset->histograms_png, kPng, "Histograms"),
                            "What was drawn, over all items.");
    }
    return html;
}

enum class FigureKind { Truth, Other };

FigureKind kind_of(const Figure& figure) {
    const bool truth = figure.file.find("truth") != std::string::npos;
    return truth ? FigureKind::Truth : FigureKind::Other;
}

std::string figures_html(const std::vector<Figure>& figures, FigureKind kind) {
    std::string html;
    for (const Figure& figure : figures) {
        if (kind_of(figure) != kind) continue;
        html += figure_html(embedded_image(figure.bytes, figure.mime_type, figure.file),
                            escape_html(figure.file));
    }
    return html;
}

std::string documents_html(const std::vector<JsonDocument>& documents) {
    std::string html;
    for (const JsonDocument& document : documents) {
        html += details_html(document.file, document.content);
    }
    return html;
}

std::string unreadable_html(const std::vector<Fact>& unreadable) {
    if (unreadable.empty()) return "";
    std::string html = "<ul class=\"errors\">";
    for (const auto& [file, error] : unreadable) {
        const bool names_file = error.starts_with(file + ": ");
        const std::string reason = names_file ? error.substr(file.size() + 2) : error;
        html += fmt::format("<li><b>{}</b>: {}</li>", escape_html(file), escape_html(reason));
    }
    return html + "</ul>\n";
}

/// What the page holds, such as `1 capture, 2 reconstructions`.
std::string contents_text(const ResultsFolder& results) {
    std::string text;
    const auto add = [&](std::size_t count, const char* thing) {
        if (count == 0) return;
        text +=
            fmt::format("{}{} {}{}", text.empty() ? "" : ", ", count, thing, count == 1 ? "" : "s");
    };
    add(results.dataset ? 1 : 0, "data set");
    add(results.captures.size(), "capture");
    add(results.volumes.size(), "reconstruction");
    add(results.fits.size(), "fit");
    add(results.tracks.size(), "track");
    add(results.scores.size(), "comparison");
    add(results.benches.size(), "benchmark");
    add(results.sweeps.size(), "sweep");
    add(results.unreadable.size(), "unreadable file");
    return text;
}

std::string header_html(const ResultsFolder& results) {
    return fmt::format(
        "<header><p class=\"kicker\">Non-line-of-sight imaging</p><h1>{}</h1>"
        "<p class=\"lead\">{}</p></header>\n",
        escape_html(results.name),
        contents_text(results));
}

}  // namespace

std::string render_report(const ResultsFolder& results) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n";
    html += fmt::format("<title>{} - nlos report</title>\n", escape_html(results.name));
    html += std::string("<style>") + kReportStyle + "</style>\n</head>\n<body>\n";
    html += header_html(results) + "<main>\n";
    html += section_html("dataset", "Data set", dataset_html(results.dataset));
    html += section_html("scores", "Scores", scores_html(results.scores));
    html += section_html("truth", "Ground truth", figures_html(results.figures, FigureKind::Truth));
    html += section_html("captures", "Captures", cards_html(results.captures, "Streak image"));
    html += section_html(
        "reconstructions", "Reconstructions", cards_html(results.volumes, "Projections"));
    html += section_html("fits", "Fits", cards_html(results.fits, "Data, model and residual"));
    html += section_html("tracks", "Tracks", cards_html(results.tracks, "Plan and histograms"));
    html +=
        section_html("comparisons", "Comparison with the truth", comparisons_html(results.scores));
    html += section_html("benchmarks", "Speed against error", benches_html(results.benches));
    html += section_html("sweeps", "Sweeps over settings", sweeps_html(results.sweeps));
    html += section_html("hard-cases", "Hard cases", hard_cases_html(results.hard_cases));
    html += section_html("figures", "Figures", figures_html(results.figures, FigureKind::Other));
    html += section_html("files", "Other files", documents_html(results.documents));
    html += section_html(
        "unreadable", "Files that could not be read", unreadable_html(results.unreadable));
    html +=
        "</main>\n<footer>Made by " + escape_html(version_text()) +
        ". Lengths in metres in the wall's frame; front views show what an eye at the wall sees: "
        "y upwards, x running right to left.</footer>\n</body>\n</html>\n";
    return html;
}

void write_report(const std::string& folder, const std::string& output_html) {
    core::write_text_file(output_html, render_report(read_results_folder(folder)));
}

}  // namespace apps
