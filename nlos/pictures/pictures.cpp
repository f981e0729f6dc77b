// SPDX-License-Identifier: MIT
#include "nlos/pictures/pictures.h"

#include "nlos/pictures/image_layout.h"
#include "nlos/pictures/map_ranges.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using Range = std::array<double, 2>;

/// A front view whose pixels are `value_of(column)`, columns stored [x][y].
template <class ValueOf>
ImagePanel front_view_of(const std::vector<double>& x_m,
                         const std::vector<double>& y_m,
                         ValueOf value_of) {
    ImagePanel panel = image_of(x_m.size(), y_m.size(), [&](std::size_t ix, std::size_t iy) {
        return value_of(ix * y_m.size() + iy);
    });
    panel.x_range = cell_edges(x_m);
    panel.y_range = cell_edges(y_m);
    panel.x_label = kWallX;
    panel.y_label = kWallY;
    panel.x_direction = AxisDirection::Reversed;
    return panel;
}

/// The same of a depth map's columns, with its title, and the label and colours of its values.
template <class ValueOf>
ImagePanel map_panel(const core::DepthMap& map,
                     const std::string& title,
                     const std::string& value_label,
                     ColourMap colour_map,
                     const std::optional<Range>& value_range,
                     ValueOf value_of) {
    ImagePanel panel = front_view_of(map.x_m, map.y_m, value_of);
    panel.title = title;
    panel.value_label = value_label;
    panel.colour_map = colour_map;
    panel.value_range = value_range;
    return panel;
}

/// A dark view of a volume along one of its axes, which shows the other two.
ImagePanel empty_projection(const char* title,
                            const std::vector<double>& across_m,
                            const char* x_label,
                            const std::vector<double>& up_m,
                            const char* y_label) {
    ImagePanel panel =
        image_of(across_m.size(), up_m.size(), [](std::size_t, std::size_t) { return 0.0F; });
    panel.title = title;
    panel.x_range = cell_edges(across_m);
    panel.y_range = cell_edges(up_m);
    panel.x_label = x_label;
    panel.y_label = y_label;
    panel.value_label = "fraction of maximum";
    panel.value_range = Range{0.0, 1.0};
    return panel;
}

/// The brightest fraction of the volume's maximum along the axis that a view looks along: from the
/// front, along wall x (depth to the right) and along wall y (wall x as in the front view, depth
/// upwards).
std::vector<ImagePanel> project(const Volume& volume) {
    const auto& [x_m, y_m, z_m, pose] = volume.axes;
    std::vector<ImagePanel> views{
        empty_projection("Front (seen from the wall)", x_m, kWallX, y_m, kWallY),
        empty_projection("Side (along wall x)", z_m, kWallDepth, y_m, kWallY),
        empty_projection("Top (along wall y)", x_m, kWallX, z_m, kWallDepth)};
    float maximum = 0.0F;
    for (const float value : volume.values) maximum = std::max(maximum, value);
    const float scale = maximum > 0.0F ? 1.0F / maximum : 0.0F;
    const auto raise = [](float& pixel, float value) { pixel = std::max(pixel, value); };
    for (std::size_t ix = 0; ix < x_m.size(); ++ix) {
        std::vector<float> along_y(z_m.size(), 0.0F);
        for (std::size_t iy = 0; iy < y_m.size(); ++iy) {
            const float* const column = volume.values.data() + volume.index(ix, iy, 0);
            float* const along_x = views[1].values.data() + iy * z_m.size();
            float along_z = 0.0F;
            for (std::size_t iz = 0; iz < z_m.size(); ++iz) {
                const float value = scale * column[iz];
                raise(along_z, value);
                raise(along_x[iz], value);
                raise(along_y[iz], value);
            }
            views[0].values[iy * x_m.size() + ix] = along_z;
        }
        for (std::size_t iz = 0; iz < z_m.size(); ++iz) {
            views[2].values[iz * x_m.size() + ix] = along_y[iz];
        }
    }
    views[0].x_direction = AxisDirection::Reversed;
    views[2].x_direction = AxisDirection::Reversed;
    return views;
}

ImagePanel depth_panel(const core::DepthMap& map,
                       const std::string& title,
                       const std::optional<Range>& range) {
    return map_panel(map, title, kWallDepth, ColourMap::Viridis, range, [&](std::size_t i) {
        return map.depth_m[i];
    });
}

/// A metre is as long in all panels; the first, the front view, has the usual size unless the
/// volume is deep.
std::vector<Panel> on_one_scale(std::vector<ImagePanel> panels) {
    constexpr double kLongest = 1.5;  // of an axis, in usual sizes
    const auto longer_side = [](const ImagePanel& panel) {
        return std::max(panel.x_range[1] - panel.x_range[0], panel.y_range[1] - panel.y_range[0]);
    };
    double longest = 0.0;
    for (const ImagePanel& panel : panels) longest = std::max(longest, longer_side(panel));
    const double full_length = std::max(longer_side(panels.front()), longest / kLongest);
    for (ImagePanel& panel : panels) panel.full_length = full_length;
    return {panels.begin(), panels.end()};
}

}  // namespace

std::vector<Panel> volume_panels(const Reconstruction& reconstruction) {
    std::vector<ImagePanel> panels = project(reconstruction.volume);
    const core::DepthMap& depth = reconstruction.depth;
    if (depth.depth_m.empty()) return on_one_scale(std::move(panels));
    panels.push_back(depth_panel(depth, "Depth map", depth_range_m(depth.depth_m)));
    const std::vector<double>& probability = reconstruction.surface_probability;
    if (probability.size() == depth.depth_m.size()) {
        panels.push_back(map_panel(depth,
                                   "Probability of a surface",
                                   "probability",
                                   ColourMap::Grey,
                                   Range{0.0, 1.0},
                                   [&](std::size_t i) { return probability[i]; }));
    }
    const std::vector<double>& sigma_m = reconstruction.depth_sigma_m;
    if (sigma_m.size() == depth.depth_m.size()) {
        const auto limit_m = sigma_limit_m(sigma_m);
        panels.push_back(
            map_panel(depth,
                      "Standard deviation of depth",
                      "standard deviation σ [mm]",
                      ColourMap::Viridis,
                      limit_m ? std::optional(Range{0.0, 1000.0 * *limit_m}) : std::nullopt,
                      [&](std::size_t i) { return 1000.0 * sigma_m[i]; }));
    }
    return on_one_scale(std::move(panels));
}

std::vector<Panel> comparison_panels(const Reconstruction& reconstruction,
                                     const core::TrueSurface& truth_of_columns) {
    const core::DepthMap& truth = truth_of_columns.main;
    const core::DepthMap& found = reconstruction.depth;
    if (found.x_m.size() != truth.x_m.size() || found.y_m.size() != truth.y_m.size()) {
        throw core::Error("comparison picture",
                          fmt::format("found {} x {} columns against {} x {}",
                                      found.x_m.size(),
                                      found.y_m.size(),
                                      truth.x_m.size(),
                                      truth.y_m.size()),
                          "both must have the same columns");
    }
    // The truth sets the colours: far-off depths of a poor result would wash out both maps.
    std::optional<Range> range = depth_range_m(truth.depth_m);
    if (!range) range = depth_range_m(found.depth_m);
    const auto limit_m = error_limit_m(truth.depth_m);
    const core::DepthMap nearest = core::nearest_surfaces(truth_of_columns, found);
    const auto error_mm = [&](std::size_t i) {
        return 1000.0 * (found.depth_m[i] - nearest.depth_m[i]);
    };
    return {depth_panel(truth, "True depth", range),
            depth_panel(found, "Reconstructed depth", range),
            map_panel(truth,
                      "Error where both are",
                      "found − true [mm]",
                      ColourMap::Diverging,
                      limit_m ? std::optional(Range{-1000.0 * *limit_m, 1000.0 * *limit_m})
                              : std::nullopt,
                      error_mm)};
}

ImagePanel front_panel(const std::vector<double>& x_m,
                       const std::vector<double>& y_m,
                       const std::vector<float>& values) {
    return front_view_of(x_m, y_m, [&](std::size_t column) { return values[column]; });
}

std::vector<Panel> truth_panels(const core::DepthMap& truth) {
    std::vector<Panel> panels{depth_panel(truth, "True depth", depth_range_m(truth.depth_m))};
    const auto add = [&](const char* title, const char* value_label, const auto& value_of) {
        panels.emplace_back(map_panel(
            truth, title, value_label, ColourMap::Grey, Range{0.0, 1.0}, [&](std::size_t i) {
                return truth.is_foreground(i) ? value_of(i) : NAN;
            }));
    };
    if (!truth.albedo.empty()) {
        add("True albedo", "albedo", [&](std::size_t i) { return truth.albedo[i]; });
    }
    if (!truth.normals.empty()) {
        const core::Vec3 to_wall = -truth.world_from_wall.linear().col(2).normalized();
        add("Facing the wall", "cosine of the normal", [&](std::size_t i) {
            return truth.normals[i].dot(to_wall);
        });
    }
    return panels;
}

}  // namespace nlos
