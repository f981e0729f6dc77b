// SPDX-License-Identifier: MIT
#include "apps/sweep/sweep.h"
#include "apps/sweep/sweep_summary.h"
#include "renderer/core/settings/json_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>

namespace apps {
namespace {

using core::Json;

constexpr std::size_t kMostCurves = 10;  // as many as there are colours
constexpr std::size_t kMostTicks = 12;
constexpr double kWideRange = 5.0;

/// What a value is along an axis: a number, or the first of a list of numbers.
std::optional<double> number_of(const Json& value) {
    if (value.is_number()) return value.get<double>();
    if (value.is_array() && !value.empty() && value.front().is_number()) {
        return value.front().get<double>();
    }
    return std::nullopt;
}

/// The index of a key among those of an axis, when the axis has two different numbers there and
/// otherwise at most null.
bool is_numeric(const SweepAxis& axis, std::size_t key) {
    std::vector<double> numbers;
    for (const auto& values : axis.values) {
        const auto number = number_of(values[key]);
        if (!number && !values[key].is_null()) return false;
        if (number) numbers.push_back(*number);
    }
    std::ranges::sort(numbers);
    return numbers.size() > 1 && std::ranges::adjacent_find(numbers) == numbers.end();
}

std::vector<SweepPlot> wanted_plots(const SweepSettings& sweep) {
    if (sweep.plots) return *sweep.plots;
    std::vector<SweepPlot> plots;
    for (const SweepAxis& axis : sweep.grid.axes) {
        std::size_t key = 0;
        while (key < axis.keys.size() && !is_numeric(axis, key)) ++key;
        if (key == axis.keys.size()) continue;
        for (const char* metric : {"depth_mae_m", "fscore_10mm", "seconds"}) {
            plots.push_back({metric, axis.keys[key]});
        }
    }
    return plots;
}

/// The names of scores and times.
std::vector<std::string> known_metrics() {
    std::vector<std::string> names;
    nlos::Metrics metrics;
    for_each_field(metrics, [&](const char* name, auto&, const char*) {
        if (!nlos::looks_at_truth(name)) names.emplace_back(name);
    });
    SweepResult result;
    for_each_field(result, [&](const std::string& name, auto&, const char*) {
        if (name.starts_with("seconds")) names.push_back(name);
    });
    return names;
}

std::string last_part(const std::string& key) {
    return key.substr(key.rfind('.') + 1);
}

std::string text_of_value(const Json& value) {
    if (value.is_null()) return "none";
    return value.is_string() ? value.get<std::string>() : value.dump();
}

/// A row's values of some axes, by the first key of each.
std::string values_text(const Json& row, const std::vector<const SweepAxis*>& axes) {
    std::string text;
    for (const SweepAxis* axis : axes) {
        const std::string& key = axis->keys.front();
        text += fmt::format(
            "{}{} {}", text.empty() ? "" : ", ", last_part(key), text_of_value(row[key]));
    }
    return text;
}

struct MeanOfRuns {
    double sum = 0.0;
    int count = 0;

    double value() const { return sum / count; }
};

/// Means along x of the rows of one curve, by rising x after null.
using Curve = std::map<std::optional<double>, MeanOfRuns>;

/// The curves of the rows that agree in the values that the title of a picture gives, by title;
/// both in the order in which they come.
using Curves = nlohmann::ordered_map<std::string, Curve>;
using Pictures = nlohmann::ordered_map<std::string, Curves>;

/// The axes beside that of x which vary, those of the curves apart from those of pictures.
struct OtherAxes {
    std::vector<const SweepAxis*> of_pictures;
    std::vector<const SweepAxis*> of_curves;
};

OtherAxes other_axes(const SweepSettings& sweep, const std::string& against) {
    OtherAxes others;
    std::size_t num_curves = 1;
    for (auto axis = sweep.grid.axes.rbegin(); axis != sweep.grid.axes.rend(); ++axis) {
        if (axis->values.size() < 2 || std::ranges::count(axis->keys, against) > 0) continue;
        num_curves *= axis->values.size();
        const bool fits = num_curves <= kMostCurves || others.of_curves.empty();
        auto& others_of_kind = fits ? others.of_curves : others.of_pictures;
        others_of_kind.insert(others_of_kind.begin(), &*axis);
    }
    return others;
}

Pictures pictures_of(const SweepSettings& sweep, const Json& rows, const SweepPlot& plot) {
    const OtherAxes others = other_axes(sweep, plot.against);
    Pictures pictures;
    for (const Json& row : rows) {
        const Json y = row.value(plot.metric, Json());
        if (!y.is_number()) continue;
        Curves& curves = pictures[values_text(row, others.of_pictures)];
        MeanOfRuns& mean = curves[values_text(row, others.of_curves)][number_of(row[plot.against])];
        mean.sum += y.get<double>();
        ++mean.count;
    }
    return pictures;
}

/// The lines of all curves and, dashed across all of x, what null gives each.
std::vector<nlos::PlotLine> lines_of(const Curves& curves, double least_x, double most_x) {
    std::vector<nlos::PlotLine> lines;
    std::vector<nlos::PlotLine> limits;
    for (const auto& [title, curve] : curves) {
        nlos::PlotLine line{title};
        for (const auto& [x, mean] : curve) {
            if (x) {
                line.add(*x, mean.value());
            } else {
                limits.push_back({"",
                                  {least_x, most_x},
                                  {mean.value(), mean.value()},
                                  nlos::LineStyle::Limit,
                                  static_cast<int>(lines.size())});
            }
        }
        lines.push_back(std::move(line));
    }
    lines.insert(lines.end(), limits.begin(), limits.end());
    return lines;
}

/// Logarithmic for what is positive and spans a wide range.
nlos::AxisScale scale_for(const std::vector<double>& values) {
    const auto [least, most] = std::ranges::minmax(values);
    return least > 0.0 && most > kWideRange * least ? nlos::AxisScale::Logarithmic
                                                    : nlos::AxisScale::Linear;
}

/// Lengths and times differ by factors; fractions, decibels and angles by differences.
nlos::AxisScale y_scale_for(const std::string& metric, const std::vector<nlos::PlotLine>& lines) {
    if (!metric.ends_with("_m") && !metric.starts_with("seconds")) return nlos::AxisScale::Linear;
    std::vector<double> values;
    for (const nlos::PlotLine& line : lines)
        values.insert(values.end(), line.y.begin(), line.y.end());
    return scale_for(values);
}

/// Nothing where no two numbers along x have results.
std::optional<nlos::Plot> plot_of(const std::string& title,
                                  const Curves& curves,
                                  const SweepPlot& wanted) {
    std::set<double> numbers;
    for (const auto& [name, curve] : curves) {
        for (const auto& [number, mean] : curve) {
            if (number) numbers.insert(*number);
        }
    }
    if (numbers.size() < 2) return std::nullopt;
    const std::vector<double> x(numbers.begin(), numbers.end());
    nlos::Plot plot;
    plot.title = title;
    plot.x_label = last_part(wanted.against);
    plot.y_label = wanted.metric;
    plot.lines = lines_of(curves, x.front(), x.back());
    if (plot.lines.size() > curves.size()) plot.x_label += " (dashed: none)";
    plot.x_scale = scale_for(x);
    plot.y_scale = y_scale_for(wanted.metric, plot.lines);
    if (x.size() <= kMostTicks) plot.x_ticks = x;
    return plot;
}

}  // namespace

void check_plots(const SweepSettings& sweep, const std::string& where) {
    const std::vector<std::string> metrics = known_metrics();
    for (const SweepPlot& plot : sweep.plots.value_or(std::vector<SweepPlot>())) {
        core::require(std::ranges::count(metrics, plot.metric) > 0,
                      where + "plots.metric",
                      plot.metric,
                      fmt::format("one of {}", fmt::join(metrics, ", ")));
        bool is_drawable = false;
        for (const SweepAxis& axis : sweep.grid.axes) {
            for (std::size_t key = 0; key < axis.keys.size(); ++key) {
                is_drawable |= axis.keys[key] == plot.against && is_numeric(axis, key);
            }
        }
        core::require(is_drawable,
                      where + "plots.against",
                      plot.against,
                      "a key of the grid with at least two different numbers");
    }
}

std::map<std::string, nlos::Plot> plots_of(const SweepSettings& sweep, const Json& rows) {
    std::map<std::string, nlos::Plot> plots;
    for (const SweepPlot& wanted : wanted_plots(sweep)) {
        std::string name = fmt::format("sweep_{}_by_{}", wanted.metric, wanted.against);
        std::ranges::replace(name, '.', '_');
        const Pictures pictures = pictures_of(sweep, rows, wanted);
        int number = 0;
        for (const auto& [title, curves] : pictures) {
            const auto plot = plot_of(title, curves, wanted);
            ++number;
            if (!plot) continue;
            plots[pictures.size() == 1 ? name : fmt::format("{}_{:02}", name, number)] = *plot;
        }
    }
    return plots;
}

}  // namespace apps
