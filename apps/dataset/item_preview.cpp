// SPDX-License-Identifier: MIT
#include "apps/dataset/item_preview.h"

#include "nlos/pictures/image_layout.h"
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
ImagePanel columns_panel(const Recipe& recipe,
                         const ItemArray& array,
                         const std::string& title,
                         const std::vector<float>& values) {
    const auto& size_m = recipe.scene.relay_wall.size_m;
    nlos::WallGrid grid;
    for (const std::size_t axis : {0, 1}) {
        grid.size[axis] = array.shape[axis];
        grid.pitch_m[axis] = size_m[axis] / static_cast<double>(array.shape[axis]);
        grid.first_m[axis] = 0.5 * (grid.pitch_m[axis] - size_m[axis]);
    }
    ImagePanel panel = nlos::wall_panel(grid, values);
    panel.title = title;
    return panel;
}

ImagePanel scene_panel(const Recipe& recipe, const Item& item, const ItemArray& normals) {
    const std::vector<float> values = values_of(normals);
    const core::Vec3 from_wall = recipe.scene.relay_wall.normal.normalized();
    std::vector<float> cosines;
    for (std::size_t i = 0; i < values.size(); i += 3) {
        const core::Vec3 normal(values[i], values[i + 1], values[i + 2]);
        cosines.push_back(static_cast<float>(std::abs(normal.dot(from_wall))));
    }
    const auto number = item.parameters.at("item").get<std::uint64_t>();
    ImagePanel panel =
        columns_panel(recipe, normals, fmt::format("item {}: scene", number), cosines);
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
    ImagePanel panel = nlos::image_of(nx, shape[0], [&](std::size_t ix, std::size_t bin) {
        return values[bin * pairs + ix * ny + ny / 2];
    });
    panel.title = "capture, middle row";
    panel.x_range = {0.0, static_cast<double>(nx)};
    panel.x_label = "sensing point";
    panel.y_range = {axis.opl_start_m, axis.opl_end_m()};
    panel.y_label = "path length [m]";
    panel.x_direction = nlos::AxisDirection::Reversed;
    panel.y_direction = nlos::AxisDirection::Reversed;
    panel.aspect = nlos::AspectRatio::Free;
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
        ImagePanel panel = columns_panel(recipe, *array, title, values_of(*array));
        panel.value_label = label;
        panel.colour_map = nlos::ColourMap::Viridis;
        panels.push_back(std::move(panel));
    };
    add("depth", "true depth", nlos::kWallDepth);
    add("object_ids", "objects", "object");
    return panels;
}

}  // namespace apps
