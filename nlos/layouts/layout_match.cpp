// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_histograms.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace nlos {
namespace {

/// Extents for the axes, by adding or leaving out extents of 1 (MATLAB drops trailing ones and
/// knows no vectors); nothing when that does not do, or would add the axis of bins.
std::optional<Shape> fitted_extents(Shape extents, const std::vector<std::string>& axes) {
    const std::size_t rank = axes.size();
    while (extents.size() < rank) {
        if (axes[extents.size()] == "t") return std::nullopt;
        extents.push_back(1);
    }
    while (extents.size() > rank) {
        if (extents.back() == 1) {
            extents.pop_back();
        } else if (extents.front() == 1) {
            extents.erase(extents.begin());
        } else {
            return std::nullopt;
        }
    }
    return extents;
}

bool has_rank(const Shape& shape, const std::vector<int>& ranks) {
    const auto wide = std::count_if(shape.begin(), shape.end(), [](auto e) { return e != 1; });
    return std::any_of(ranks.begin(), ranks.end(), [&](int rank) {
        return rank == wide || static_cast<std::size_t>(rank) == shape.size();
    });
}

/// Makes two axes of one whose extent is the product of two scalars; false when they do not fit.
bool split_axis(const LayoutFiles& files, const LayoutSplit& split, HistogramArray& array) {
    const auto found = std::find(array.axes.begin(), array.axes.end(), split.axis);
    if (found == array.axes.end()) return false;
    const auto axis = found - array.axes.begin();
    Shape extents;
    for (const LayoutNumber& extent : split.extents) {
        if (!extent.value && !files.has(extent.array)) return false;
        const auto values =
            extent.value ? std::vector<double>{*extent.value} : files.read(extent.array);
        if (values.size() != 1 || !(values[0] >= 1.0 && values[0] < 1e9)) return false;
        extents.push_back(static_cast<std::size_t>(values[0]));
    }
    if (extents[0] * extents[1] != array.extents[static_cast<std::size_t>(axis)]) return false;
    array.axes.erase(found);
    array.axes.insert(array.axes.begin() + axis, split.into.begin(), split.into.end());
    array.extents.erase(array.extents.begin() + axis);
    array.extents.insert(array.extents.begin() + axis, extents.begin(), extents.end());
    return true;
}

bool has_value(const LayoutFiles& files, const std::string& name, double wanted) {
    if (!files.has(name)) return false;
    const std::vector<double> values = files.read(name);
    return values.size() == 1 && values[0] == wanted;
}

/// Whether points stand with their coordinates first, which files of reversed axes have.
bool has_coordinates_first(const LayoutFiles& files, const LayoutPoints& points) {
    if (points.array.empty() || !files.has(points.array)) return false;
    const Shape shape = files.shape(points.array);
    return !shape.empty() && shape.front() == 3 && shape.back() != 3;
}

}  // namespace

std::optional<std::size_t> HistogramArray::extent(const std::string& axis) const {
    const auto found = std::find(axes.begin(), axes.end(), axis);
    if (found == axes.end()) return std::nullopt;
    return extents[static_cast<std::size_t>(found - axes.begin())];
}

std::optional<HistogramArray> find_histograms(const LayoutFiles& files, const Layout& layout) {
    for (const std::string& name : layout.histogram.array) {
        if (!files.has(name)) continue;
        const auto extents = fitted_extents(files.shape(name), layout.histogram.axes);
        if (!extents) continue;
        HistogramArray array{name, layout.histogram.axes, *extents, false};
        array.reversed =
            layout.histogram.also_reversed && has_coordinates_first(files, layout.sensing);
        if (array.reversed) std::reverse(array.axes.begin(), array.axes.end());
        if (layout.histogram.split && !split_axis(files, *layout.histogram.split, array)) continue;
        if (layout.histogram.square && array.extent("x") != array.extent("y")) continue;
        return array;
    }
    return std::nullopt;
}

std::vector<std::string> mismatches(const LayoutFiles& files, const Layout& layout) {
    const LayoutRecognition& wanted = layout.recognise;
    std::vector<std::string> lacks;
    const std::string container = files.main().container();
    const auto& kinds = wanted.containers;
    if (!kinds.empty() && std::find(kinds.begin(), kinds.end(), container) == kinds.end()) {
        lacks.push_back(fmt::format("it is {} instead of {}", container, fmt::join(kinds, ", ")));
    }
    for (const auto& [name, ranks] : wanted.arrays.of) {
        if (!files.has(name) && files.main().has_object(name)) {
            lacks.push_back(fmt::format("{} is a {}", name, files.main().type(name)));
        } else if (!files.has(name)) {
            lacks.push_back(fmt::format("no array {}", name));
        } else if (!has_rank(files.shape(name), ranks)) {
            lacks.push_back(fmt::format("{} has shape {} instead of {} axes",
                                        name,
                                        shape_text(files.shape(name)),
                                        fmt::join(ranks, " or ")));
        }
    }
    for (const auto& [name, value] : wanted.values) {
        if (!has_value(files, name, value))
            lacks.push_back(fmt::format("{} is not {}", name, value));
    }
    for (const std::string& name : wanted.absent) {
        if (files.has(name)) lacks.push_back(fmt::format("there is an array {}", name));
    }
    const auto folder = std::filesystem::path(files.path()).parent_path();
    for (const std::string& name : wanted.beside) {
        if (!std::filesystem::is_regular_file(folder / name)) {
            lacks.push_back(fmt::format("no file {} beside it", name));
        }
    }
    if (wanted.alone && files.main().names().size() > 1) {
        lacks.push_back(fmt::format("it holds {} arrays", files.main().names().size()));
    }
    if (!find_histograms(files, layout)) {
        lacks.push_back(fmt::format("no array {} with axes ({}){}",
                                    fmt::join(layout.histogram.array, " or "),
                                    fmt::join(layout.histogram.axes, ", "),
                                    layout.histogram.square ? " and x as long as y" : ""));
    }
    return lacks;
}

}  // namespace nlos
