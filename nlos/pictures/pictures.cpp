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

/// A panel of the wall's plane as seen from the wall.
ImagePanel front_view(const std::vector<double>& x_m, const std::vector<double>& y_m) {
    ImagePanel panel;
    panel.width = x_m.size();
    panel.height = y_m.size();
    panel.values.assign(panel.width * panel.height, NAN);
    panel.x_range = cell_edges(x_m);
    panel.y_range = cell_edges(y_m);
    panel.x_label = "x [m]";
    panel.y_label = "y [m]";
    panel.x_direction = AxisDirection::Reversed;
    return panel;
}

/// A front view whose pixels are `value_of(column)`, columns stored [x][y].
template <class ValueOf>
ImagePanel front_view_of(const std::vector<double>& x_m,
                         const std::vector<double>& y_m,
                         ValueOf value_of) {
    ImagePanel panel = front_view(x_m, y_m);
    for (std::size_t ix = 0; ix < x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < y_m.size(); ++iy) {
            panel.values[iy * x_m.size() + ix] = static_cast<float>(value_of(ix * y_m.size() + iy));
        }
    }
    return panel;
}

/// The brightest share of the volume's maximum along the axis that a view looks along.
struct Projections {
    ImagePanel front;
    ImagePanel side;  ///< looks along x: z to the right, y upwards
    ImagePanel top;   ///< looks along y: x as in the front view, z upwards
};

ImagePanel empty_projection(const std::string& title) {
    ImagePanel panel;
    panel.title = title;
    panel.value_label = "share of maximum";
    panel.value_range = Range{0.0, 1.0};
    return panel;
}

Projections project(const Volume& volume) {
    const VolumeAxes& axes = volume.axes;
    const std::size_t nx = axes.x_m.size();
    const std::size_t ny = axes.y_m.size();
    const std::size_t nz = axes.z_m.size();
    const auto set = [](ImagePanel& panel, std::size_t width, std::size_t height) {
        panel.width = width;
        panel.height = height;
        panel.values.assign(width * height, 0.0F);
    };
    Projections views{empty_projection("Front (seen from the wall)"),
                      empty_projection("Side (along x)"),
                      empty_projection("Top (along y)")};
    set(views.front, nx, ny);
    set(views.side, nz, ny);
    set(views.top, nx, nz);
    float maximum = 0.0F;
    for (const float value : volume.values) maximum = std::max(maximum, value);
    const float scale = maximum > 0.0F ? 1.0F / maximum : 0.0F;
    for (std::size_t ix = 0; ix < nx; ++ix) {
        for (std::size_t iy = 0; iy < ny; ++iy) {
            for (std::size_t iz = 0; iz < nz; ++iz) {
                const float value = scale * volume.values[volume.index(ix, iy, iz)];
                const auto raise = [&](float& pixel) { pixel = std::max(pixel, value); };
                raise(views.front.values[iy * nx + ix]);
                raise(views.side.values[iy * nz + iz]);
                raise(views.top.values[iz * nx + ix]);
            }
        }
    }
    return views;
}

void label_projections(const VolumeAxes& axes, Projections& views) {
    const Range x = cell_edges(axes.x_m);
    const Range y = cell_edges(axes.y_m);
    const Range z = cell_edges(axes.z_m);
    const auto label =
        [](ImagePanel& panel, Range across, const char* x_label, Range up, const char* y_label) {
            panel.x_range = across;
            panel.x_label = x_label;
            panel.y_range = up;
            panel.y_label = y_label;
        };
    label(views.front, x, "x [m]", y, "y [m]");
    label(views.side, z, "z [m]", y, "y [m]");
    label(views.top, x, "x [m]", z, "z [m]");
    views.front.x_direction = AxisDirection::Reversed;
    views.top.x_direction = AxisDirection::Reversed;
    // One scale for all three, on which the wall has the usual size.
    constexpr double kDeepest = 3.0;  // against the wall
    const double wall = std::max(x[1] - x[0], y[1] - y[0]);
    const double full_length = std::max(wall, (z[1] - z[0]) / kDeepest);
    for (ImagePanel* panel : {&views.front, &views.side, &views.top}) {
        panel->full_length = full_length;
    }
}

ImagePanel depth_panel(const core::DepthMap& map,
                       const std::string& title,
                       const std::optional<Range>& range) {
    ImagePanel panel =
        front_view_of(map.x_m, map.y_m, [&](std::size_t i) { return map.depth_m[i]; });
    panel.title = title;
    panel.value_label = "depth z [m]";
    panel.colour_map = ColourMap::Viridis;
    panel.value_range = range;
    return panel;
}

ImagePanel probability_panel(const core::DepthMap& map, const std::vector<double>& probability) {
    ImagePanel panel =
        front_view_of(map.x_m, map.y_m, [&](std::size_t i) { return probability[i]; });
    panel.title = "Probability of a surface";
    panel.value_label = "probability";
    panel.colour_map = ColourMap::Grey;
    panel.value_range = Range{0.0, 1.0};
    return panel;
}

ImagePanel sigma_panel(const core::DepthMap& map, const std::vector<double>& sigma_m) {
    ImagePanel panel =
        front_view_of(map.x_m, map.y_m, [&](std::size_t i) { return 1000.0 * sigma_m[i]; });
    panel.title = "Standard deviation of depth";
    panel.value_label = "standard deviation σ [mm]";
    panel.colour_map = ColourMap::Viridis;
    if (const auto limit_m = sigma_limit_m(sigma_m)) panel.value_range = {0.0, 1000.0 * *limit_m};
    return panel;
}

}  // namespace

std::vector<Panel> volume_panels(const Reconstruction& reconstruction) {
    Projections views = project(reconstruction.volume);
    label_projections(reconstruction.volume.axes, views);
    std::vector<Panel> panels{views.front, views.side, views.top};
    const core::DepthMap& depth = reconstruction.depth;
    if (depth.depth_m.empty()) return panels;
    panels.emplace_back(depth_panel(depth, "Depth map", depth_range_m(depth.depth_m)));
    if (reconstruction.surface_probability.size() == depth.depth_m.size()) {
        panels.emplace_back(probability_panel(depth, reconstruction.surface_probability));
    }
    if (reconstruction.depth_sigma_m.size() == depth.depth_m.size()) {
        panels.emplace_back(sigma_panel(depth, reconstruction.depth_sigma_m));
    }
    return panels;
}

std::vector<Panel> comparison_panels(const Reconstruction& reconstruction,
                                     const core::DepthMap& truth) {
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
    ImagePanel error = front_view_of(truth.x_m, truth.y_m, [&](std::size_t i) {
        return 1000.0 * (found.depth_m[i] - truth.depth_m[i]);
    });
    error.title = "Error where both are";
    error.value_label = "found − true [mm]";
    error.colour_map = ColourMap::Diverging;
    if (const auto limit_m = error_limit_m(truth.depth_m)) {
        error.value_range = {-1000.0 * *limit_m, 1000.0 * *limit_m};
    }
    return {depth_panel(truth, "True depth", range),
            depth_panel(found, "Reconstructed depth", range),
            error};
}

ImagePanel front_panel(const std::vector<double>& x_m,
                       const std::vector<double>& y_m,
                       const std::vector<float>& values) {
    return front_view_of(x_m, y_m, [&](std::size_t column) { return values[column]; });
}

std::vector<Panel> truth_panels(const core::DepthMap& truth) {
    std::vector<Panel> panels{depth_panel(truth, "True depth", depth_range_m(truth.depth_m))};
    if (!truth.albedo.empty()) {
        ImagePanel panel = front_view_of(truth.x_m, truth.y_m, [&](std::size_t i) {
            return truth.is_foreground(i) ? truth.albedo[i] : NAN;
        });
        panel.title = "True albedo";
        panel.value_label = "albedo";
        panel.colour_map = ColourMap::Grey;
        panel.value_range = Range{0.0, 1.0};
        panels.emplace_back(std::move(panel));
    }
    if (!truth.normals.empty()) {
        const core::Vec3 to_wall = -truth.world_from_wall.linear().col(2).normalized();
        ImagePanel panel = front_view_of(truth.x_m, truth.y_m, [&](std::size_t i) {
            return truth.is_foreground(i) ? truth.normals[i].dot(to_wall) : NAN;
        });
        panel.title = "Facing the wall";
        panel.value_label = "cosine of the normal";
        panel.colour_map = ColourMap::Grey;
        panel.value_range = Range{0.0, 1.0};
        panels.emplace_back(std::move(panel));
    }
    return panels;
}

}  // namespace nlos
