// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout.h"

#include "renderer/core/error.h"
#include "renderer/core/nearest_name.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace nlos {

using core::Error;
using core::Json;

void read_value(const Json& json, const std::string& where, LayoutNumber& number) {
    if (json.is_number()) {
        number.value = json.get<double>();
        return;
    }
    core::read_value<LayoutNumber>(json, where, number);
}

Json write_value(const LayoutNumber& number) {
    return number.value ? Json(*number.value) : core::write_value<LayoutNumber>(number);
}

void read_value(const Json& json, const std::string& where, LayoutRanks& ranks) {
    if (!json.is_object()) core::throw_wrong_type(where, json, "an object of numbers of axes");
    ranks.of.clear();
    for (const auto& [name, value] : json.items()) {
        const Json list = value.is_array() ? value : Json::array({value});
        core::read_value(list, where + "." + name, ranks.of[name]);
    }
}

Json write_value(const LayoutRanks& ranks) {
    return ranks.of;
}

namespace {

/// Axes of histograms that say which pair, bin or frame a value belongs to.
const std::vector<std::string> kHistogramAxes{
    "t", "x", "y", "lx", "ly", "sx", "sy", "l", "s", "pair", "frame", "order"};

void require_lengths(const std::vector<double>& list, std::size_t count, const std::string& where) {
    core::require(list.empty() || list.size() == count,
                  where,
                  static_cast<double>(list.size()),
                  fmt::format("{} numbers", count));
}

void check_points(const LayoutPoints& points, const std::string& where) {
    const int ways =
        static_cast<int>(points.grid.has_value()) + static_cast<int>(!points.array.empty()) +
        static_cast<int>(!points.x.empty() && !points.y.empty()) +
        static_cast<int>(!points.index.empty()) + static_cast<int>(!points.position_m.empty()) +
        static_cast<int>(!points.corners.empty());
    core::require(ways == 1,
                  where,
                  fmt::format("{} ways to say where the points are", ways),
                  "one of grid, array, x and y, index, position_m, corners");
    core::require(points.corners.empty() || points.corners.size() == 3,
                  core::join_key(where, "corners"),
                  static_cast<double>(points.corners.size()),
                  "three arrays");
    require_lengths(points.position_m, 3, core::join_key(where, "position_m"));
    core::require(points.columns.size() == 3,
                  core::join_key(where, "columns"),
                  static_cast<double>(points.columns.size()),
                  "three of x, y and z");
    for (const std::string& column : points.columns) {
        const std::string letter = column.substr(column.starts_with('-') ? 1 : 0);
        core::require(letter == "x" || letter == "y" || letter == "z",
                      core::join_key(where, "columns"),
                      column,
                      "x, y or z, with - to negate");
    }
    if (!points.grid) return;
    const std::string grid = core::join_key(where, "grid");
    for (const auto* list :
         {&points.grid->size_m, &points.grid->half_size_m, &points.grid->pitch_m}) {
        core::require(list->size() <= 2, grid, static_cast<double>(list->size()), "[x, y] at most");
    }
    core::require(
        points.grid->size_m.size() + points.grid->half_size_m.size() + points.grid->pitch_m.size() >
            0,
        grid,
        "neither size nor pitch",
        "one of size_m, half_size_m, pitch_m");
}

}  // namespace

void validate(const Layout& layout, const std::string& where) {
    const auto key = [&](const char* name) { return core::join_key(where, name); };
    core::require(!layout.name.empty(), key("name"), "an empty text", "a short name");
    core::require(
        !layout.histogram.array.empty(), key("histogram.array"), "none", "at least one array");
    const auto& axes = layout.histogram.axes;
    core::require(std::count(axes.begin(), axes.end(), "t") == 1,
                  key("histogram.axes"),
                  fmt::format("{} axes named t", std::count(axes.begin(), axes.end(), "t")),
                  "exactly one");
    for (const std::string& axis : kHistogramAxes) {
        core::require(std::count(axes.begin(), axes.end(), axis) <= 1,
                      key("histogram.axes"),
                      axis + " twice",
                      "every axis once");
    }
    const auto has_axis = [&](const char* name) { return std::ranges::count(axes, name) > 0; };
    core::require(
        !has_axis("order") || !(has_axis("frame") || layout.files_are_frames || layout.bins.shift ||
                                !layout.histogram.background.empty()),
        key("histogram.axes"),
        "order",
        "no order beside frames, delays or a background");
    if (layout.histogram.split) {
        core::require(
            layout.histogram.split->into.size() == 2 && layout.histogram.split->extents.size() == 2,
            key("histogram.split"),
            "other numbers of names or extents",
            "two of each");
    }
    core::require(layout.bins.width_m.is_given() != layout.bins.width_s.is_given(),
                  key("bins"),
                  "no or two widths",
                  "one of width_m and width_s");
    check_points(layout.sensing, key("sensing"));
    if (layout.pattern != LayoutPattern::Confocal) {
        check_points(layout.illumination, key("illumination"));
    }
    require_lengths(layout.devices.position_m, 3, key("devices.position_m"));
}

Layout read_layout(const std::string& path) {
    Layout layout;
    core::read_value(core::read_json_file(path), path, layout);
    validate(layout, path);
    return layout;
}

const std::vector<Layout>& shipped_layouts() {
    static const std::vector<Layout> layouts = [] {
        std::vector<Layout> list;
        for (const auto& [name, text] : shipped_layout_texts()) {
            const std::string where = fmt::format("layout {}", name);
            core::read_value(Json::parse(text), where, list.emplace_back());
            validate(list.back(), where);
        }
        return list;
    }();
    return layouts;
}

Layout find_layout(const std::string& name_or_path) {
    std::vector<std::string> names;
    for (const Layout& layout : shipped_layouts()) {
        if (layout.name == name_or_path) return layout;
        names.push_back(layout.name);
    }
    if (std::filesystem::is_regular_file(name_or_path)) return read_layout(name_or_path);
    throw Error("layout " + name_or_path,
                "is unknown",
                core::did_you_mean(name_or_path, names) +
                    fmt::format("must be a JSON file, or one of {}", fmt::join(names, ", ")));
}

}  // namespace nlos
