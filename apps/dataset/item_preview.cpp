// SPDX-License-Identifier: MIT
#include "apps/dataset/item_preview.h"

#include "nlos/pictures/light_scale.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace apps {
namespace {

using nlos::ImagePanel;

const ItemArray* find_array(const Item& item, const char* name) {
    const auto found = std::find_if(
        item.arrays.begin(), item.arrays.end(), [&](auto& array) { return array.name == name; });
    return found == item.arrays.end() ? nullptr : &*found;
}

/// The values of an array, as the file's readers take them.
std::vector<float> values_of(const ItemArray& array) {
    std::size_t count = 1;
    for (const std::size_t extent : array.shape) count *= extent;
    const std::string bytes = nlos::convert_numbers(
        array.bytes.data(), count, array.number, std::endian::native, nlos::Precision::Single);
    std::vector<float> values(count);
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

/// An image of columns (X, Y) over the wall, as an eye at the wall sees it.
template <class Value>
ImagePanel wall_panel(const Recipe& recipe,
                      const ItemArray& array,
                      const std::string& title,
                      const Value& value) {
    const auto& [width_m, height_m] = recipe.scene.relay_wall.size_m;
    ImagePanel panel;
    panel.title = title;
    panel.width = array.shape[0];
    panel.height = array.shape[1];
    for (std::size_t iy = 0; iy < panel.height; ++iy) {
        for (std::size_t ix = 0; ix < panel.width; ++ix) {
            panel.values.push_back(value(ix * panel.height + iy));
        }
    }
    panel.x_range = {-0.5 * width_m, 0.5 * width_m};
    panel.y_range = {-0.5 * height_m, 0.5 * height_m};
    panel.x_label = "wall x [m]";
    panel.y_label = "wall y [m]";
    panel.x_direction = nlos::AxisDirection::Reversed;
    return panel;
}

ImagePanel scene_panel(const Recipe& recipe, const Item& item, const ItemArray& normals) {
    const std::vector<float> values = values_of(normals);
    const core::Vec3 from_wall = recipe.scene.relay_wall.normal.normalized();
    ImagePanel panel =
        wall_panel(recipe,
                   normals,
                   fmt::format("item {}: scene", item.parameters.at("item").get<std::uint64_t>()),
                   [&](std::size_t i) {
                       const core::Vec3 normal(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
                       return static_cast<float>(std::abs(normal.dot(from_wall)));
                   });
    panel.colour_map = nlos::ColourMap::Grey;
    panel.value_label = "cosine";
    panel.value_range = {0.0, 1.0};
    return panel;
}

/// Histograms of a grid (T, X, Y), or of a list or an exhaustive scan without the points between.
ImagePanel streak_panel_of(const Recipe& recipe, const ItemArray& histograms) {
    const std::vector<float> values = values_of(histograms);
    const core::TimeAxis& axis = recipe.scene.time_axis;
    const nlos::Shape& shape = histograms.shape;
    const std::size_t pairs = values.size() / shape[0];
    const std::size_t ny = shape.size() > 2 ? shape.back() : 1;
    const std::size_t nx = shape.size() > 2 ? shape[shape.size() - 2] : shape.back();
    ImagePanel panel;
    panel.title = "capture, middle row";
    panel.width = nx;
    panel.height = shape[0];
    for (std::size_t bin = 0; bin < shape[0]; ++bin) {
        for (std::size_t ix = 0; ix < nx; ++ix) {
            panel.values.push_back(values[bin * pairs + ix * ny + ny / 2]);
        }
    }
    panel.x_range = {0.0, static_cast<double>(nx)};
    panel.x_label = "sensing point";
    panel.y_range = {axis.opl_start_m, axis.opl_end_m()};
    panel.y_label = "path length [m]";
    panel.x_direction = nlos::AxisDirection::Reversed;
    panel.y_direction = nlos::AxisDirection::Reversed;
    panel.scale = nlos::AxisScale::Free;
    panel.value_scale = nlos::ValueScale::Gamma;
    panel.value_label = recipe.detector ? "counts per bin" : nlos::kRenderedRadiancePerBin;
    return panel;
}

}  // namespace

std::vector<nlos::Panel> preview_panels(const Recipe& recipe, const Item& item) {
    std::vector<nlos::Panel> panels;
    if (const ItemArray* normals = find_array(item, "normals")) {
        panels.push_back(scene_panel(recipe, item, *normals));
    }
    panels.push_back(streak_panel_of(recipe, *find_array(item, "H")));
    const auto add = [&](const char* name, const char* title, const char* label) {
        const ItemArray* array = find_array(item, name);
        if (array == nullptr) return;
        const std::vector<float> values = values_of(*array);
        ImagePanel panel =
            wall_panel(recipe, *array, title, [&](std::size_t i) { return values[i]; });
        panel.value_label = label;
        panel.colour_map = nlos::ColourMap::Viridis;
        panels.push_back(std::move(panel));
    };
    add("depth", "true depth", "depth [m]");
    add("object_ids", "objects", "object");
    return panels;
}

}  // namespace apps
