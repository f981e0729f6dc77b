// SPDX-License-Identifier: MIT
#include "apps/report/report.h"

#include "apps/page/html.h"
#include "apps/report/bench_panels.h"
#include "apps/report/metrics_table.h"
#include "apps/report/summary.h"
#include "apps/version.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/output_file.h"

#include <fmt/core.h>

#include <algorithm>

namespace apps {

/// The style sheet of pages, compiled in.
extern const char* const kPageStyle;

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

/// Where the page's script puts a view; `fallback` stands there without it.
std::string view_html(const std::string& kind,
                      const std::string& attributes = "",
                      const std::string& fallback = "") {
    return fmt::format(
        "<div class=\"view\" data-view=\"{}\"{}>{}</div>\n", kind, attributes, fallback);
}

std::string folded_html(const std::string& title, const std::string& content) {
    if (content.empty()) return "";
    return fmt::format("<details><summary>{}</summary>{}</details>\n", escape_html(title), content);
}

std::string picture_html(const ResultPanel& panel, const std::string& picture_of) {
    if (panel.picture_png.empty()) return "";
    return "<figure>" + embedded_image(panel.picture_png, kPng, picture_of + " of " + panel.file) +
           "</figure>\n";
}

/// A panel: its heading, what is seen of it, facts, and the rest folded.
std::string panel_html(const ResultPanel& panel,
                       const std::string& seen,
                       const std::string& folded = "") {
    const bool has_label = !panel.label.empty();
    return fmt::format("<article><h3>{}{}</h3>\n",
                       escape_html(has_label ? panel.label : panel.file),
                       has_label ? "<small>" + escape_html(panel.file) + "</small>" : "") +
           seen + facts_html(panel.facts) + notes_html(panel.notes) + folded +
           details_html("Settings and provenance", panel.settings) + "</article>\n";
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
                "<p class=\"hint\">The best value of a column is marked where results can be "
                "compared by it.</p>\n";
        }
    }
    return html;
}

/// Pictures of comparisons, but for those that stand side by side with the truth already.
std::string comparisons_html(const ResultsFolder& results) {
    std::string html;
    for (const ScoredResult& scored : results.scores) {
        const bool is_volume = std::any_of(
            results.volumes.begin(), results.volumes.end(), [&](const ResultPanel& volume) {
                return volume.file == scored.result;
            });
        if (scored.picture_png.empty() || (is_volume && results.views.truth)) continue;
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

std::string panels_html(const std::vector<ResultPanel>& panels, const std::string& picture_of) {
    std::string html;
    for (const ResultPanel& panel : panels)
        html += panel_html(panel, picture_html(panel, picture_of));
    return html;
}

std::string reconstructions_html(const std::vector<ResultPanel>& volumes) {
    std::string html;
    for (const ResultPanel& volume : volumes) {
        html += panel_html(
            volume,
            "",
            folded_html("Projections and depth as a picture", picture_html(volume, "Projections")));
    }
    return html;
}

/// Captures, each with its animation.
std::string captures_html(const std::vector<ResultPanel>& captures) {
    std::string html;
    for (std::size_t i = 0; i < captures.size(); ++i) {
        html += panel_html(
            captures[i],
            view_html("animation", fmt::format(" data-animation=\"{}\"", i)),
            folded_html("Streak image, light over the wall and mean transient as a picture",
                        picture_html(captures[i], "Streak image")));
    }
    return html;
}

/// The 3-D view, with a picture of what it would show.
std::string space_html(const ResultsFolder& results) {
    if (!results.views.has_space()) return "";
    std::string fallback;
    if (!results.volumes.empty()) {
        fallback = embedded_image(results.volumes.front().picture_png, kPng, "Projections");
    } else if (!results.captures.empty()) {
        fallback = embedded_image(results.captures.front().picture_png, kPng, "Capture");
    }
    return figure_html(view_html("space", "", fallback), escape_html(space_caption(results)));
}

/// Maps of all results beside the truth, and two of them over each other.
std::string side_by_side_html(const ResultsFolder& results) {
    if (results.views.results.empty()) return "";
    return figure_html(view_html("matrix"),
                       "Seen from the wall: wall y upwards, wall x running right to left. A row "
                       "has one scale; depth errors are found minus true.") +
           figure_html(view_html("pair"), "Two of these over each other: move the divider.");
}

std::string slices_html(const ResultsFolder& results) {
    if (results.views.results.empty()) return "";
    return figure_html(view_html("slices"),
                       "Cuts through a volume at one voxel; click to move the cross.");
}

std::string dataset_html(const std::optional<DatasetPanel>& dataset) {
    if (!dataset) return "";
    std::string html = panel_html(dataset->panel, picture_html(dataset->panel, "First items"));
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

/// The truth is not drawn twice.
std::string figures_html(const ResultsFolder& results, FigureKind kind) {
    if (kind == FigureKind::Truth && results.views.truth) return "";
    std::string html;
    for (const Figure& figure : results.figures) {
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

/// A part of the page; its anchor is the title in small letters.
struct Section {
    std::string title;
    std::string content;
};

std::string anchor_of(std::string title) {
    std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) {
        return c == ' ' ? '-' : static_cast<char>(std::tolower(c));
    });
    return title;
}

std::string header_html(const ResultsFolder& results) {
    return fmt::format(
        "<header><p class=\"kicker\">Non-line-of-sight imaging</p><h1>{}</h1>"
        "<p class=\"summary\">{}</p></header>\n",
        escape_html(results.name),
        escape_html(summary_text(results)));
}

/// The titles of the sections that hold something.
std::string contents_html(const std::vector<Section>& sections) {
    std::string html = "<nav aria-label=\"Contents\"><ul>";
    for (const Section& section : sections) {
        if (section.content.empty()) continue;
        html +=
            fmt::format("<li><a href=\"#{}\">{}</a></li>", anchor_of(section.title), section.title);
    }
    return html + "</ul></nav>\n";
}

std::vector<Section> sections_of(const ResultsFolder& results) {
    return {{"Data set", dataset_html(results.dataset)},
            {"Hidden scene", space_html(results)},
            {"Scores", scores_html(results.scores)},
            {"Side by side", side_by_side_html(results)},
            {"Slices", slices_html(results)},
            {"Ground truth", figures_html(results, FigureKind::Truth)},
            {"Captures", captures_html(results.captures)},
            {"Reconstructions", reconstructions_html(results.volumes)},
            {"Fits", panels_html(results.fits, "Data, model and residual")},
            {"Tracks", panels_html(results.tracks, "Plan and histograms")},
            {"Comparison with the truth", comparisons_html(results)},
            {"Speed against error", benches_html(results.benches)},
            {"Sweeps over settings", sweeps_html(results.sweeps)},
            {"Hard cases", hard_cases_html(results.hard_cases)},
            {"Figures", figures_html(results, FigureKind::Other)},
            {"Other files", documents_html(results.documents)},
            {"Files that could not be read", unreadable_html(results.unreadable)}};
}

}  // namespace

std::string render_report(const ResultsFolder& results, double limit_bytes) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n";
    html += fmt::format("<title>{} - nlos report</title>\n", escape_html(results.name));
    html += std::string("<style>") + kPageStyle + "</style>\n</head>\n<body>\n";
    const std::vector<Section> sections = sections_of(results);
    html += header_html(results) + contents_html(sections) + "<main>\n";
    for (const Section& section : sections) {
        html += section_html(anchor_of(section.title), section.title, section.content);
    }
    html +=
        "</main>\n<footer>Made by " + escape_html(version_text()) +
        ". Lengths are in metres; wall x, wall y and depth are of the wall's frame, x, y and z "
        "alone of the world's. Front views show what an eye at the wall sees: wall y upwards, wall "
        "x running right to left.</footer>\n";
    return html + views_html(results.views, limit_bytes) + "</body>\n</html>\n";
}

void write_report(const std::string& output_html,
                  const ResultsFolder& results,
                  const ReportOptions& options) {
    core::write_text_file(output_html, render_report(results, 1e6 * options.data_mb));
}

}  // namespace apps
