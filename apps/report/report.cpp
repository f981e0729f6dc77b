// SPDX-License-Identifier: MIT
#include "apps/report/report.h"

#include "apps/page/html.h"
#include "apps/report/bench_panels.h"
#include "apps/report/metrics_table.h"
#include "apps/report/page_room.h"
#include "apps/report/summary.h"
#include "apps/version.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/output_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <ranges>

namespace apps {

/// The style sheet of pages, compiled in.
extern const char* const kPageStyle;

namespace {

/// JSON, folded; a word in its place where the page has no room for it.
std::string details_html(const std::string& title, const core::Json& json, const PageRoom& room) {
    if (json.is_null()) return "";
    const std::string text = json.dump(2, ' ', false, core::Json::error_handler_t::replace);
    if (text.size() > room.longest_json) {
        return fmt::format("<p class=\"hint\">{} (left out)</p>\n", escape_html(title));
    }
    return fmt::format("<details><summary>{}</summary><pre>{}</pre></details>\n",
                       escape_html(title),
                       escape_html(text));
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

std::string picture_html(const ResultPanel& panel, const std::string& picture_of, PageRoom& room) {
    if (panel.picture_png.empty()) return "";
    return "<figure>" + room.pictures.image(panel.picture_png, picture_of + " of " + panel.file) +
           "</figure>\n";
}

/// A panel: its heading, what is seen of it, facts, and the rest folded.
std::string panel_html(const ResultPanel& panel,
                       const PageRoom& room,
                       const std::string& seen,
                       const std::string& folded = "") {
    const bool has_label = !panel.label.empty();
    return fmt::format("<article><h3>{}{}</h3>\n",
                       escape_html(has_label ? panel.label : panel.file),
                       has_label ? "<small>" + escape_html(panel.file) + "</small>" : "") +
           seen + facts_html(panel.facts) + notes_html(panel.notes) + folded +
           details_html("Settings and provenance", panel.settings, room) + "</article>\n";
}

/// A section with an anchor; nothing when it has no content.
std::string section_html(const std::string& anchor,
                         const std::string& title,
                         const std::string& content) {
    if (content.empty()) return "";
    return fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", anchor, title, content);
}

std::string scores_html(const std::vector<ScoredResult>& scores, const PageRoom& room) {
    std::vector<ScoredResult> shown;
    const std::string others = listed_html(scores, room, [&](const ScoredResult& scored) {
        shown.push_back(scored);
        return "";
    });
    std::string html;
    for (const std::vector<ScoredResult>& group : groups_by_threshold(shown)) {
        html += metrics_tiles(group) + metrics_table(group);
        if (group.size() > 1) {
            html +=
                "<p class=\"hint\">The best value of a column is marked where results can be "
                "compared by it.</p>\n";
        }
    }
    return html + others;
}

/// Whether the maps of a scored result stand beside the true ones.
bool is_beside_truth(const ScoredResult& scored,
                     const ResultsFolder& results,
                     const PageRoom& room) {
    if (!results.views.truth || !room.views.detail.has_views) return false;
    const auto volume =
        std::ranges::find(results.volumes, scored.result, [](const auto& v) { return v.file; });
    return volume != results.volumes.end() &&
           room.views.detail.shows_result(
               results.views, static_cast<std::size_t>(volume - results.volumes.begin()));
}

/// Pictures of comparisons, but for those that stand side by side with the truth already.
std::string comparisons_html(const ResultsFolder& results, PageRoom& room) {
    return listed_html(results.scores, room, [&](const ScoredResult& scored) -> std::string {
        if (scored.picture_png.empty() || is_beside_truth(scored, results, room)) return "";
        std::string caption = "<b>" + escape_html(scored.name) + "</b>";
        if (!scored.result.empty()) {
            caption += fmt::format(
                ": {} against {}", escape_html(scored.result), escape_html(scored.reference));
        }
        return figure_html(room.pictures.image(scored.picture_png, "Comparison with the truth"),
                           caption);
    });
}

std::string panels_html(const std::vector<ResultPanel>& panels,
                        const std::string& picture_of,
                        PageRoom& room) {
    return listed_html(panels, room, [&](const ResultPanel& panel) {
        return panel_html(panel, room, picture_html(panel, picture_of, room));
    });
}

/// The picture of a result stands folded where views show the result, else open.
std::string reconstructions_html(const ResultsFolder& results, PageRoom& room) {
    const ViewDetail& detail = room.views.detail;
    std::size_t next = 0;
    return listed_html(results.volumes, room, [&](const ResultPanel& volume) {
        const bool is_viewed = detail.has_views && detail.shows_result(results.views, next++);
        const std::string picture = picture_html(volume, "Projections", room);
        if (!is_viewed) return panel_html(volume, room, picture);
        return panel_html(
            volume, room, "", folded_html("Projections and depth as a picture", picture));
    });
}

/// Captures, each with its animation, and the picture folded; without an animation it stands open.
std::string captures_html(const ResultsFolder& results, PageRoom& room) {
    const ViewDetail& detail = room.views.detail;
    std::size_t next = 0;
    return listed_html(results.captures, room, [&](const ResultPanel& capture) {
        const std::size_t i = next++;
        const std::string picture = picture_html(capture, "Streak image", room);
        if (!detail.has_views || i >= detail.most) return panel_html(capture, room, picture);
        return panel_html(
            capture,
            room,
            view_html("animation", fmt::format(" data-animation=\"{}\"", i)),
            folded_html("Streak image, light over the wall and mean transient as a picture",
                        picture));
    });
}

/// What a caption says where there is no room for the views of all results.
std::string share_text(const ResultsFolder& results, const PageRoom& room) {
    const std::size_t most = room.views.detail.most;
    const std::size_t count = results.views.results.size();
    if (most >= count) return "";
    return fmt::format(" Of {} results, {} are shown here.", count, most);
}

/// The 3-D view, with a picture of what it would show.
std::string space_html(const ResultsFolder& results, PageRoom& room) {
    if (!results.views.has_space() || !room.views.detail.has_views) return "";
    std::string fallback;
    if (!results.volumes.empty()) {
        fallback = room.pictures.image(results.volumes.front().picture_png, "Projections");
    } else if (!results.captures.empty()) {
        fallback = room.pictures.image(results.captures.front().picture_png, "Capture");
    }
    return figure_html(view_html("space", "", fallback),
                       escape_html(space_caption(results) + share_text(results, room)));
}

bool has_maps(const ResultsFolder& results, const PageRoom& room) {
    return room.views.detail.has_views && room.views.detail.most > 0 &&
           !results.views.results.empty();
}

/// Maps of all results beside the truth, and two of them over each other.
std::string side_by_side_html(const ResultsFolder& results, const PageRoom& room) {
    if (!has_maps(results, room)) return "";
    return figure_html(view_html("matrix"),
                       "Seen from the wall: wall y upwards, wall x running right to left. A row "
                       "has one scale; depth errors are found minus true." +
                           share_text(results, room)) +
           figure_html(view_html("pair"), "Two of these over each other: move the divider.");
}

std::string slices_html(const ResultsFolder& results, const PageRoom& room) {
    if (!has_maps(results, room)) return "";
    return figure_html(
        view_html("slices"),
        "Cuts through a volume at one voxel; click to move the cross." + share_text(results, room));
}

std::string dataset_html(const std::optional<DatasetPanel>& dataset, PageRoom& room) {
    if (!dataset) return "";
    std::string html =
        panel_html(dataset->panel, room, picture_html(dataset->panel, "First items", room));
    if (!dataset->histograms_png.empty()) {
        html += figure_html(room.pictures.image(dataset->histograms_png, "Histograms"),
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
std::string figures_html(const ResultsFolder& results, FigureKind kind, PageRoom& room) {
    if (kind == FigureKind::Truth && results.views.truth) return "";
    const auto is_wanted = [&](const Figure& figure) { return kind_of(figure) == kind; };
    return listed_html(results.figures | std::views::filter(is_wanted), room, [&](const auto& f) {
        return figure_html(room.pictures.image(f.bytes, f.file), escape_html(f.file));
    });
}

std::string unreadable_html(const std::vector<UnreadableFile>& unreadable, const PageRoom& room) {
    std::string items;
    const std::string others = listed_html(unreadable, room, [&](const UnreadableFile& unread) {
        const auto& [file, error] = unread;
        const bool names_file = error.starts_with(file + ": ");
        const std::string reason = names_file ? error.substr(file.size() + 2) : error;
        items += fmt::format("<li><b>{}</b>: {}</li>", escape_html(file), escape_html(reason));
        return "";
    });
    return (items.empty() ? "" : "<ul class=\"errors\">" + items + "</ul>\n") + others;
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

std::string header_html(const ResultsFolder& results, const PageRoom& room) {
    const std::string reductions = reductions_text(results.views, room);
    return fmt::format(
        "<header><p class=\"kicker\">Non-line-of-sight imaging</p><h1>{}</h1>"
        "<p class=\"summary\">{}</p>{}</header>\n",
        escape_html(results.name),
        escape_html(summary_text(results)),
        reductions.empty() ? "" : "<p class=\"reduced\">" + escape_html(reductions) + "</p>");
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

std::vector<Section> sections_of(const ResultsFolder& results, PageRoom& room) {
    return {
        {"Data set", dataset_html(results.dataset, room)},
        {"Hidden scene", space_html(results, room)},
        {"Scores", scores_html(results.scores, room)},
        {"Side by side", side_by_side_html(results, room)},
        {"Slices", slices_html(results, room)},
        {"Ground truth", figures_html(results, FigureKind::Truth, room)},
        {"Captures", captures_html(results, room)},
        {"Reconstructions", reconstructions_html(results, room)},
        {"Fits", panels_html(results.fits, "Data, model and residual", room)},
        {"Tracks", panels_html(results.tracks, "Plan and histograms", room)},
        {"Comparison with the truth", comparisons_html(results, room)},
        {"Speed against error",
         listed_html(results.benches,
                     room,
                     [&](const BenchPanel& bench) { return bench_html(bench, room.pictures); })},
        {"Sweeps over settings",
         listed_html(results.sweeps,
                     room,
                     [&](const SweepPanel& sweep) { return sweep_html(sweep, room.pictures); })},
        {"Hard cases", hard_cases_html(results.hard_cases)},
        {"Figures", figures_html(results, FigureKind::Other, room)},
        {"Other files",
         listed_html(results.documents,
                     room,
                     [&](const JsonDocument& document) {
                         return details_html(document.file, document.content, room);
                     })},
        {"Files that could not be read", unreadable_html(results.unreadable, room)}};
}

/// All that the page says, with pictures but without the data of its views.
std::string text_html(const ResultsFolder& results, PageRoom& room) {
    const std::vector<Section> sections = sections_of(results, room);
    std::string html = header_html(results, room) + contents_html(sections) + "<main>\n";
    for (const Section& section : sections) {
        html += section_html(anchor_of(section.title), section.title, section.content);
    }
    return html + "</main>\n<footer>Made by " + escape_html(version_text()) +
           ". Lengths are in metres; wall x, wall y and depth are of the wall's frame, x, y and z "
           "alone of the world's. Front views show what an eye at the wall sees: wall y upwards, "
           "wall x running right to left.</footer>\n";
}

std::size_t longest_section(const ResultsFolder& results) {
    return std::max({results.scores.size(),
                     results.captures.size(),
                     results.volumes.size(),
                     results.fits.size(),
                     results.tracks.size(),
                     results.benches.size(),
                     results.sweeps.size(),
                     results.figures.size(),
                     results.documents.size(),
                     results.unreadable.size()});
}

}  // namespace

Report render_report(const ResultsFolder& results, double limit_bytes) {
    PageRoom room =
        fit_page(results.views, limit_bytes, longest_section(results), [&](PageRoom& tried) {
            return text_html(results, tried);
        });
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n";
    html += fmt::format("<title>{} - nlos report</title>\n", escape_html(results.name));
    html += std::string("<style>") + kPageStyle + "</style>\n</head>\n<body>\n";
    html += text_html(results, room) + room.views.html() + "</body>\n</html>\n";
    return {std::move(html), reductions_text(results.views, room)};
}

std::string write_report(const std::string& output_html,
                         const ResultsFolder& results,
                         const ReportOptions& options) {
    const Report report = render_report(results, 1e6 * options.data_mb);
    core::write_text_file(output_html, report.html);
    return report.reductions;
}

}  // namespace apps
