// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_guess.h"

#include "nlos/layouts/array_list.h"
#include "nlos/layouts/histogram_evidence.h"
#include "nlos/layouts/layout_histograms.h"
#include "renderer/core/error.h"
#include "renderer/core/nearest_name.h"
#include "renderer/core/settings/json_file.h"

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

std::size_t count_of(const Shape& shape) {
    return total_bytes(shape, 1);
}

bool is_numeric(const ArrayReader& file, const std::string& name) {
    const ElementKind kind = file.kind(name);
    return kind == ElementKind::Integer || kind == ElementKind::Real;
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

void guess_points(const LayoutFiles& files,
                  const std::string& histograms,
                  std::size_t pairs,
                  bool is_list,
                  LayoutGuess& guess) {
    const bool is_matlab = files.first_index_fastest(histograms);
    if (const auto points = find_points(files, pairs)) {
        guess.layout["sensing"] = {{"array", *points}};
        guess.findings.push_back(fmt::format("{} could be the wall points", *points));
        return;
    }
    const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(pairs))));
    if (is_list && side * side != pairs) {
        guess.layout["sensing"] = {{"array", "?"}};
        guess.findings.push_back(
            "open: the wall points; sensing.array names an array of 3 coordinates each");
        return;
    }
    if (is_list) {
        guess.layout["histogram"]["split"] = {{"axis", "s"},
                                              {"into", other_axes({side, side}, is_matlab)},
                                              {"extents", {side, side}}};
        guess.findings.push_back(fmt::format(
            "open: whether the {} points are a grid of {} x {}, as histogram.split says; else "
            "sensing.array names an array of 3 coordinates each",
            pairs,
            side,
            side));
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

/// Histograms have two axes or more.
bool could_be_histograms(const Shape& shape) {
    return std::count_if(shape.begin(), shape.end(), [](auto e) { return e > 1; }) >= 2;
}

/// A layout around the array `name`.
void guess_around(const LayoutFiles& files,
                  const std::string& name,
                  const HistogramEvidence& evidence,
                  LayoutGuess& guess) {
    const Shape shape = files.shape(name);
    const std::size_t time = evidence.time_axis;
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
                    evidence.variation,
                    evidence.next_variation));
    if (axes.size() == 3) {
        guess.findings.push_back("open: which of the other axes is x, and how each runs");
    }
    guess.layout = Json::object();
    guess.layout["name"] = std::filesystem::path(files.path()).stem().string();
    guess.layout["title"] = guess.layout["name"];
    guess.layout["recognise"]["containers"] = {files.main().container()};
    guess.layout["recognise"]["arrays"][name] = shape.size();
    guess.layout["histogram"] = {{"array", {name}}, {"axes", axes}};
    guess.layout["histogram"]["unit"] = evidence.are_whole_numbers ? "counts" : "radiance";
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
    guess_points(files, name, pairs, is_list, guess);
    if (has_lights) guess.layout["illumination"] = guess.layout["sensing"];
}

/// Takes an array for the histograms unless something speaks against it, which is noted.
bool guess_by(const LayoutFiles& files, const std::string& name, LayoutGuess& guess) {
    constexpr std::size_t kMostNoted = 8;
    if (!could_be_histograms(files.shape(name))) return false;
    HistogramEvidence evidence;
    try {
        evidence = weigh_as_histograms(files, name);
    } catch (const core::Error& error) {
        evidence.why_not = reason_of(error, name);
    }
    if (evidence.why_not.empty()) {
        guess_around(files, name, evidence, guess);
        return true;
    }
    if (guess.findings.size() < kMostNoted) {
        guess.findings.push_back(fmt::format("{} {} is hardly histograms: {}",
                                             name,
                                             shape_text(files.shape(name)),
                                             evidence.why_not));
    }
    return false;
}

}  // namespace

LayoutGuess guess_layout(const std::string& path) {
    const LayoutFiles files(path);
    LayoutGuess guess;
    guess.arrays = list_arrays(files);
    for (const std::string& name : numeric_arrays(files)) {
        if (guess_by(files, name, guess)) break;
    }
    if (guess.layout.is_null()) {
        guess.findings.push_back("no array could be histograms, which have two axes or more");
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
