// SPDX-License-Identifier: MIT
#include "apps/report/metrics_table.h"

#include "apps/page/html.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

namespace apps {
namespace {

enum class Better { Lower, Higher, Neither };

/// How a metric is shown: stored value x factor, in `unit`.
struct MetricStyle {
    std::string_view key;
    std::string_view label;
    double factor;
    std::string_view unit;
    Better better;
};

// Errors of depths and normals are of what was found alone, and the projection's amplitudes are no
// albedo: for these there is no best.
constexpr std::array<MetricStyle, 34> kStyles{{
    {"depth_mae_m", "Depth error, mean", 1e3, "mm", Better::Neither},
    {"depth_median_m", "Depth error, median", 1e3, "mm", Better::Neither},
    {"depth_rmse_m", "Depth error, RMS", 1e3, "mm", Better::Neither},
    {"depth_coverage", "... of this fraction of the surface", 1e2, "%", Better::Higher},
    {"mask_iou", "Mask IoU at 20 %", 1e2, "%", Better::Higher},
    {"mask_iou_stated", "Mask IoU, as the result reports", 1e2, "%", Better::Higher},
    {"normal_mae_deg", "Normal error, mean", 1.0, "deg", Better::Neither},
    {"normal_median_deg", "Normal error, median", 1.0, "deg", Better::Neither},
    {"chamfer_m", "Chamfer distance", 1e3, "mm", Better::Lower},
    {"fscore", "F-score", 1e2, "%", Better::Higher},
    {"completeness", "Completeness: true surface found", 1e2, "%", Better::Higher},
    {"accuracy", "Accuracy: found surface true", 1e2, "%", Better::Higher},
    {"accuracy_m", "Distance of found to true surface", 1e3, "mm", Better::Neither},
    {"fscore_threshold_m", "Threshold of F, completeness, accuracy", 1e3, "mm", Better::Neither},
    {"fscore_10mm", "F-score within 10 mm", 1e2, "%", Better::Higher},
    {"fscore_resolution", "F-score within the data's resolution", 1e2, "%", Better::Higher},
    {"resolution_m", "... which is", 1e3, "mm", Better::Neither},
    {"psnr_db", "PSNR of the projection", 1.0, "dB", Better::Neither},
    {"ssim", "SSIM of the projection", 1.0, "", Better::Neither},
    {"peak_distance_m", "Peak to truth", 1e3, "mm", Better::Lower},
    {"position_error_m", "Position error", 1e3, "mm", Better::Lower},
    {"rotation_error_deg", "Rotation error", 1.0, "deg", Better::Lower},
    {"size_error", "Size error", 1e2, "%", Better::Lower},
    {"albedo_error", "Albedo error", 1e2, "%", Better::Lower},
    {"rel_l2", "Relative L2", 1e2, "%", Better::Lower},
    {"rel_mse", "Relative MSE", 1.0, "", Better::Lower},
    {"track_rmse_m", "Track RMSE", 1e3, "mm", Better::Lower},
    {"track_median_m", "Track error, median", 1e3, "mm", Better::Lower},
    {"track_coverage", "Coverage of 95 % ellipsoids", 1e2, "%", Better::Neither},
    {"track_latency_s", "Track latency", 1.0, "s", Better::Lower},
    {"track_false_alarms", "Frames with false alarms", 1e2, "%", Better::Lower},
    {"track_missed", "Targets missed", 1e2, "%", Better::Lower},
    {"seconds", "Time", 1.0, "s", Better::Lower},
    {"peak_rss_bytes", "Peak memory", 1e-6, "MB", Better::Lower},
}};

/// One metric of all results.
struct MetricColumn {
    std::string key;
    std::string meaning;
    std::vector<std::optional<double>> values;  ///< one per result, as stored
};

/// The fields of Metrics, in their order, that any result has.
std::vector<MetricColumn> columns_of(const std::vector<ScoredResult>& scores) {
    std::vector<MetricColumn> columns;
    for (const ScoredResult& scored : scores) {
        nlos::Metrics metrics = scored.metrics;
        std::size_t next = 0;
        for_each_field(metrics, [&](const char* name, const auto& field, const char* meaning) {
            if (nlos::looks_at_truth(name)) return;
            if (next == columns.size()) columns.push_back({name, meaning, {}});
            std::optional<double> value;
            if (field) value = static_cast<double>(*field);
            columns[next++].values.push_back(value);
        });
    }
    std::erase_if(columns, [](const MetricColumn& column) {
        return std::none_of(column.values.begin(), column.values.end(), [](const auto& value) {
            return value.has_value();
        });
    });
    return columns;
}

MetricStyle style_of(const MetricColumn& column) {
    const auto it = std::find_if(kStyles.begin(), kStyles.end(), [&](const MetricStyle& style) {
        return style.key == column.key;
    });
    if (it != kStyles.end()) return *it;
    return {column.key, column.key, 1.0, "", Better::Neither};
}

/// Three significant digits, trailing zeros included, so that a column reads evenly.
std::string three_digits(double value) {
    const double size = std::abs(value);
    if (size == 0.0) return "0";
    if (size < 1e-3 || size >= 1e6) return fmt::format("{:.2e}", value);
    if (size >= 99.95) return fmt::format("{:.0f}", value);
    return fmt::format("{:#.3g}", value);
}

/// The best value of a metric; nothing when best has no meaning here.
std::optional<double> best_value(const MetricColumn& column, Better better) {
    if (better == Better::Neither) return std::nullopt;
    std::optional<double> best;
    for (const auto& value : column.values) {
        if (!value) continue;
        const bool improves = !best || (better == Better::Lower ? *value < *best : *value > *best);
        if (improves) best = value;
    }
    return best;
}

/// A metric as a column of the table: a cell per result. Results that read the same are equally
/// good; where all do, none is marked.
std::vector<std::string> cells_of(const MetricColumn& column, const MetricStyle& style) {
    const auto text_of = [&](const std::optional<double>& value) {
        return value ? three_digits(*value * style.factor) : std::string();
    };
    const std::string best = text_of(best_value(column, style.better));
    const bool is_contest =
        std::any_of(column.values.begin(), column.values.end(), [&](const auto& value) {
            return value && !best.empty() && text_of(value) != best;
        });
    std::vector<std::string> cells;
    for (const auto& value : column.values) {
        if (!value) {
            cells.emplace_back("<td class=\"none\">&ndash;</td>");
        } else {
            const bool is_best = is_contest && text_of(value) == best;
            cells.push_back(fmt::format("<td{} data-value=\"{}\">{}</td>",
                                        is_best ? " class=\"best\"" : "",
                                        *value,
                                        text_of(value)));
        }
    }
    return cells;
}

}  // namespace

std::string metrics_table(const std::vector<ScoredResult>& scores) {
    std::string html =
        "<div class=\"scroll\"><table class=\"scores sortable\"><thead><tr><th>Result</th>";
    std::vector<std::string> rows;
    for (const ScoredResult& scored : scores) {
        rows.push_back("<tr><th>" + escape_html(scored.name));
        if (!scored.result.empty()) {
            rows.back() += fmt::format("<small>{} against {}</small>",
                                       escape_html(scored.result),
                                       escape_html(scored.reference));
        }
        rows.back() += "</th>";
    }
    for (const MetricColumn& column : columns_of(scores)) {
        const MetricStyle style = style_of(column);
        html += fmt::format("<th title=\"{}\">{}<span class=\"unit\">{}</span></th>",
                            escape_html(column.meaning),
                            escape_html(style.label),
                            escape_html(style.unit));
        const std::vector<std::string> cells = cells_of(column, style);
        for (std::size_t i = 0; i < rows.size(); ++i) rows[i] += cells[i];
    }
    html += "</tr></thead><tbody>\n";
    for (const std::string& row : rows) html += row + "</tr>\n";
    return html + "</tbody></table></div>\n";
}

std::vector<std::vector<ScoredResult>> groups_by_threshold(
    const std::vector<ScoredResult>& scores) {
    constexpr double kSame_m = 1e-6;
    std::vector<std::vector<ScoredResult>> groups;
    std::vector<std::optional<double>> thresholds;
    for (const ScoredResult& scored : scores) {
        const auto& threshold = scored.metrics.fscore_threshold_m;
        std::size_t group = 0;
        while (group < groups.size() && threshold && thresholds[group] &&
               std::abs(*threshold - *thresholds[group]) > kSame_m) {
            ++group;
        }
        if (group == groups.size()) {
            groups.emplace_back();
            thresholds.emplace_back();
        }
        groups[group].push_back(scored);
        if (threshold) thresholds[group] = threshold;
    }
    return groups;
}

std::string metrics_tiles(const std::vector<ScoredResult>& scores) {
    const auto leader =
        std::max_element(scores.begin(), scores.end(), [](const auto& a, const auto& b) {
            return a.metrics.fscore_10mm.value_or(-1.0) < b.metrics.fscore_10mm.value_or(-1.0);
        });
    if (leader == scores.end() || !leader->metrics.fscore_10mm) return "";
    const nlos::Metrics& best = leader->metrics;
    std::string html;
    const auto add = [&](const std::string& label,
                         const std::optional<double>& value,
                         double factor,
                         const std::string& unit,
                         const std::string& remark) {
        if (!value) return;
        html += fmt::format(
            "<div class=\"tile\"><span>{}</span><b>{}<i>{}</i></b><small>{}</small></div>",
            escape_html(label),
            three_digits(*value * factor),
            unit,
            escape_html(remark));
    };
    add("Depth error, mean",
        best.depth_mae_m,
        1e3,
        "mm",
        fmt::format("over {} % of the true surface; {}",
                    three_digits(1e2 * best.depth_coverage.value_or(0.0)),
                    leader->name));
    add("F-score within 10 mm", best.fscore_10mm, 1e2, "%", leader->name);
    const std::string within = three_digits(1e3 * best.fscore_threshold_m.value_or(0.0)) + " mm";
    add("Completeness", best.completeness, 1e2, "%", "of the true surface within " + within);
    add("Accuracy", best.accuracy, 1e2, "%", "of the found surface within " + within);
    return "<div class=\"tiles\">" + html + "</div>\n";
}

}  // namespace apps
