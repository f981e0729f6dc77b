// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_guess.h"

#include "nlos/layouts/layout_histograms.h"
#include "renderer/core/error.h"
#include "renderer/core/json_file.h"
#include "renderer/core/nearest_name.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <optional>

namespace nlos {
namespace {

using core::Json;

constexpr std::size_t kMostListed = 200;
constexpr std::size_t kFewestTimeBins = 16;
constexpr std::size_t kMostRead = std::size_t{1} << 22;  // values, for a range in the list

std::size_t count_of(const Shape& shape) {
    return total_bytes(shape, 1);
}

bool is_numeric(const ArrayReader& file, const std::string& name) {
    const ElementKind kind = file.kind(name);
    return kind == ElementKind::Integer || kind == ElementKind::Real;
}

std::string shown(const std::string& text) {
    constexpr std::size_t kLongest = 60;
    const std::string first = text.substr(0, std::min(text.find('\n'), kLongest));
    return first.size() < text.size() ? first + " ..." : first;
}

std::string describe_array(const LayoutFiles& files, const std::string& name) {
    const ArrayReader& file = files.main();
    std::string line = fmt::format("{}: {}", name, file.type(name));
    if (file.kind(name) == ElementKind::Text)
        return line + " \"" + shown(file.read_text(name)) + "\"";
    const Shape shape = files.shape(name);
    line += " " + shape_text(shape);
    if (!is_numeric(file, name) || count_of(shape) == 0 || count_of(shape) > kMostRead) return line;
    const std::vector<double> values = files.read(name);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return values.size() == 1 ? fmt::format("{}: {:.6g}", line, *low)
                              : fmt::format("{}, {:.6g} to {:.6g}", line, *low, *high);
}

/// A line for each array; of cells one stands for all.
std::vector<std::string> list_arrays(const LayoutFiles& files) {
    std::vector<std::string> lines;
    std::string last_cell;
    std::size_t alike = 0;
    const auto count_alike = [&] {
        if (alike > 0) lines.back() += fmt::format("; and {} more such cells", alike);
        alike = 0;
    };
    for (const std::string& name : files.main().names()) {
        const std::size_t brace = name.find('{');
        const std::string cell = brace == std::string::npos ? "" : name.substr(0, brace);
        if (!cell.empty() && cell == last_cell) {
            ++alike;
            continue;
        }
        count_alike();
        last_cell = cell;
        if (lines.size() == kMostListed) {
            lines.emplace_back("...");
            break;
        }
        if (files.main().has(name)) lines.push_back(describe_array(files, name));
    }
    count_alike();
    return lines;
}

/// Names of numeric arrays, the largest first.
std::vector<std::string> numeric_arrays(const LayoutFiles& files) {
    std::vector<std::string> names;
    for (const std::string& name : files.main().names()) {
        if (files.has(name) && is_numeric(files.main(), name)) names.push_back(name);
    }
    std::stable_sort(names.begin(), names.end(), [&](const auto& a, const auto& b) {
        return count_of(files.shape(a)) > count_of(files.shape(b));
    });
    return names;
}

struct ArrayStatistics {
    /// How much the energy varies along each axis: standard deviation over mean of the sum of
    /// absolute values at each index, in the writer's order of axes.
    std::vector<double> variation;
    bool are_whole_numbers = true;
};

ArrayStatistics statistics_of(const LayoutFiles& files, const std::string& name) {
    ArrayStatistics statistics;
    const Shape shape = files.shape(name);
    std::vector<std::vector<double>> energy;
    for (const std::size_t extent : shape) energy.emplace_back(extent, 0.0);
    std::vector<std::size_t> fastest(shape.size());
    std::iota(fastest.begin(), fastest.end(), std::size_t{0});
    if (!files.first_index_fastest(name)) std::reverse(fastest.begin(), fastest.end());
    std::vector<std::size_t> index(shape.size(), 0);
    files.read_runs(name, [&](const std::vector<float>& values) {
        for (const float value : values) {
            if (value != std::trunc(value)) statistics.are_whole_numbers = false;
            if (std::isfinite(value)) {
                for (std::size_t axis = 0; axis < shape.size(); ++axis) {
                    energy[axis][index[axis]] += std::abs(value);
                }
            }
            for (const std::size_t axis : fastest) {
                if (++index[axis] < shape[axis]) break;
                index[axis] = 0;
            }
        }
    });
    for (const auto& sums : energy) {
        const double n = static_cast<double>(sums.size());
        const double mean = std::accumulate(sums.begin(), sums.end(), 0.0) / n;
        double variance = 0.0;
        for (const double sum : sums) variance += (sum - mean) * (sum - mean) / n;
        statistics.variation.push_back(mean > 0.0 ? std::sqrt(variance) / mean : 0.0);
    }
    return statistics;
}

/// The scalar whose name holds one of some words and whose value a test accepts.
struct NamedScalar {
    std::string name;
    double value;
};

std::optional<NamedScalar> find_scalar(const LayoutFiles& files,
                                       const std::vector<std::string>& words,
                                       const std::function<bool(double)>& accepts) {
    for (const std::string& name : files.main().names()) {
        if (!files.has(name) || !is_numeric(files.main(), name)) continue;
        if (count_of(files.shape(name)) != 1) continue;
        const std::string lower = core::lower_case(name);
        const double value = files.read(name).at(0);
        const bool is_named = std::any_of(words.begin(), words.end(), [&](const auto& word) {
            return lower.find(word) != std::string::npos;
        });
        if (is_named && accepts(value)) return NamedScalar{name, value};
    }
    return std::nullopt;
}

/// Names for the axes beside time, by how many there are.
std::vector<std::string> other_axes(const Shape& extents, bool is_matlab) {
    const std::vector<std::string> xy =
        is_matlab ? std::vector<std::string>{"y", "x"} : std::vector<std::string>{"x", "y"};
    switch (extents.size()) {
        case 0:
            return {};
        case 1:
            return {"s"};
        case 2:
            return xy;
        case 4:
            return {"lx", "ly", "sx", "sy"};
        default:
            break;
    }
    // The shortest of three is summed: colours, bounces; or it counts frames, which the user says.
    std::vector<std::string> names(extents.size(), "");
    const auto shortest = std::min_element(extents.begin(), extents.end()) - extents.begin();
    std::size_t next = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const bool is_point_axis = static_cast<std::ptrdiff_t>(i) != shortest && next < 2;
        names[i] = is_point_axis ? xy[next++] : fmt::format("summed{}", i);
    }
    return names;
}

/// An array of three coordinates for each of `count` points.
std::optional<std::string> find_points(const LayoutFiles& files, std::size_t count) {
    for (const std::string& name : numeric_arrays(files)) {
        const Shape shape = files.shape(name);
        const bool has_coordinates = !shape.empty() && (shape.front() == 3 || shape.back() == 3);
        if (has_coordinates && count_of(shape) == 3 * count) return name;
    }
    return std::nullopt;
}

void guess_bins(const LayoutFiles& files, LayoutGuess& guess) {
    const std::vector<std::string> words{"delta", "dt", "bin", "res", "width_t", "ts", "tick"};
    const auto between = [](double low, double high) {
        return [=](double value) { return value >= low && value <= high; };
    };
    Json& bins = guess.layout["bins"];
    if (const auto s = find_scalar(files, words, between(1e-13, 1e-8))) {
        bins["width_s"] = {{"array", s->name}};
        guess.findings.push_back(
            fmt::format("{} = {:.4g} could be the bin width in seconds", s->name, s->value));
    } else if (const auto m = find_scalar(files, words, between(1e-5, 1.0))) {
        bins["width_m"] = {{"array", m->name}};
        guess.findings.push_back(
            fmt::format("{} = {:.4g} could be the bin width in metres of path", m->name, m->value));
    } else if (const auto ps = find_scalar(files, words, between(1.0, 2000.0))) {
        bins["width_s"] = {{"array", ps->name}, {"factor", 1e-12}};
        guess.findings.push_back(
            fmt::format("{} = {:.4g} could be the bin width in ps", ps->name, ps->value));
    } else {
        bins["width_m"] = {{"ask", "0.0012 for 4 ps, 0.0048 for 16 ps, 0.0096 for 32 ps"}};
        guess.findings.push_back("open: the bin width, --set capture.bin_width_m=... or bins");
    }
    bins["start_m"] = 0;
    guess.findings.push_back(
        "open: whether bin 0 begins when light leaves the wall; bins.start_m says otherwise");
}

void guess_points(const LayoutFiles& files, std::size_t pairs, bool is_list, LayoutGuess& guess) {
    if (const auto points = find_points(files, pairs)) {
        guess.layout["sensing"] = {{"array", *points}};
        guess.findings.push_back(fmt::format("{} could be the wall points", *points));
        return;
    }
    if (is_list) {
        guess.layout["sensing"] = {{"array", "?"}};
        guess.findings.push_back(
            "open: the wall points; sensing.array names an array of 3 coordinates each");
        return;
    }
    const auto is_size = [](double value) { return value >= 0.05 && value <= 20.0; };
    Json grid = Json::object();
    if (const auto size = find_scalar(files, {"size", "width", "wall", "aperture"}, is_size)) {
        grid["size_m"] = Json::array({{{"array", size->name}}});
        guess.findings.push_back(
            fmt::format("{} = {:.4g} could be the scanned width in metres; half of it: half_size_m",
                        size->name,
                        size->value));
    } else {
        grid["size_m"] = Json::array({{{"ask", "[2,2] for a wall of 2 m"}}});
        guess.findings.push_back("open: the scanned extents, --set capture.wall_size_m=[..,..]");
    }
    grid["x"] = "increasing";
    grid["y"] = "decreasing";
    guess.layout["sensing"] = {{"grid", grid}};
}

/// Histograms have two axes or more, and a list of points has three columns.
bool could_be_histograms(const Shape& shape) {
    const auto wide = std::count_if(shape.begin(), shape.end(), [](auto e) { return e > 1; });
    const bool has_bins =
        std::any_of(shape.begin(), shape.end(), [](auto e) { return e >= kFewestTimeBins; });
    const bool is_list_of_points = shape.size() == 2 && (shape.front() == 3 || shape.back() == 3);
    return wide >= 2 && has_bins && !is_list_of_points;
}

double second_largest(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.size() > 1 ? values[values.size() - 2] : 0.0;
}

/// A layout around the array `name`.
void guess_around(const LayoutFiles& files, const std::string& name, LayoutGuess& guess) {
    const Shape shape = files.shape(name);
    const ArrayStatistics statistics = statistics_of(files, name);
    const std::vector<double>& variation = statistics.variation;
    const auto time = static_cast<std::size_t>(
        std::max_element(variation.begin(), variation.end()) - variation.begin());
    Shape others = shape;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(time));
    std::vector<std::string> axes = other_axes(others, files.first_index_fastest(name));
    const bool is_list = axes.size() == 1;
    const bool has_lights = axes.size() == 4;
    axes.insert(axes.begin() + static_cast<std::ptrdiff_t>(time), "t");
    guess.findings.push_back(fmt::format("{} {} could be the histograms, its axes ({})",
                                         name,
                                         shape_text(shape),
                                         fmt::join(axes, ", ")));
    guess.findings.push_back(
        fmt::format("axis {} is taken for time: energy varies most along it ({:.2f} of its mean; "
                    "others {:.2f})",
                    time,
                    variation[time],
                    second_largest(variation)));
    if (axes.size() == 3) {
        guess.findings.push_back("open: which of the other axes is x, and how each runs");
    }
    guess.layout = Json::object();
    guess.layout["name"] = std::filesystem::path(files.path()).stem().string();
    guess.layout["title"] = guess.layout["name"];
    guess.layout["recognise"]["containers"] = {files.main().container()};
    guess.layout["recognise"]["arrays"][name] = shape.size();
    guess.layout["histogram"] = {{"array", {name}}, {"axes", axes}};
    guess.layout["histogram"]["unit"] = statistics.are_whole_numbers ? "counts" : "radiance";
    guess_bins(files, guess);
    guess.layout["pattern"] = has_lights ? "exhaustive" : "confocal";
    guess.findings.push_back(
        has_lights ? "four axes of points: taken for an exhaustive scan"
                   : "open: whether each point is lit and seen (confocal) or one spot "
                     "is lit (single, with illumination.position_m)");
    std::size_t pairs = 1;
    for (std::size_t i = 0; i < shape.size(); ++i) {
        const bool counts = axes[i] == "x" || axes[i] == "y" || axes[i] == "s";
        if (counts) pairs *= shape[i];
    }
    guess_points(files, pairs, is_list, guess);
    if (has_lights) guess.layout["illumination"] = guess.layout["sensing"];
}

}  // namespace

LayoutGuess guess_layout(const std::string& path) {
    const LayoutFiles files(path);
    LayoutGuess guess;
    guess.arrays = list_arrays(files);
    for (const std::string& name : numeric_arrays(files)) {
        if (!could_be_histograms(files.shape(name))) continue;
        guess_around(files, name, guess);
        break;
    }
    if (guess.layout.is_null()) {
        guess.findings.push_back("no array has the two axes or more that histograms need");
    }
    guess.nearest = nearest_layouts(path);
    return guess;
}

std::vector<std::string> nearest_layouts(const std::string& path) {
    const LayoutFiles files(path);
    std::vector<std::pair<std::size_t, std::string>> rows;
    for (const Layout& layout : shipped_layouts()) {
        const std::vector<std::string> lacks = mismatches(files, layout);
        rows.emplace_back(lacks.size(), fmt::format("{}: {}", layout.name, fmt::join(lacks, ", ")));
    }
    std::stable_sort(
        rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    constexpr std::size_t kMostShown = 3;
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < std::min(kMostShown, rows.size()); ++i) {
        lines.push_back(rows[i].second);
    }
    return lines;
}

}  // namespace nlos
