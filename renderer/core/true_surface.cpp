// SPDX-License-Identifier: MIT
#include "renderer/core/true_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace core {
namespace {

/// Surfaces nearer together than this fraction of a column's width are one.
constexpr double kOneSurface = 0.5;

/// A view half as fine has a sample within this many of the finer one's.
constexpr std::size_t kReach = 2;

/// Steeper than this (depth per width) nothing is taken for a slope.
constexpr double kSteepest = 10.0;

/// From one of evenly spaced centres to the next; 0 for a single one.
double step_m(const std::vector<double>& centres_m) {
    if (centres_m.size() < 2) return 0.0;
    return (centres_m.back() - centres_m.front()) / static_cast<double>(centres_m.size() - 1);
}

/// Joins samples of one column, given by depth, into surfaces.
std::vector<ColumnSurface> surfaces_of(std::vector<ColumnSurface> samples, double one_surface_m) {
    std::sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) {
        return a.depth_m < b.depth_m;
    });
    std::vector<ColumnSurface> surfaces;
    for (std::size_t first = 0; first < samples.size();) {
        ColumnSurface surface{0.0, Vec3::Zero(), 0.0, 0.0};
        std::size_t next = first;
        while (
            next < samples.size() &&
            (next == first || samples[next].depth_m - samples[next - 1].depth_m <= one_surface_m)) {
            surface.depth_m += samples[next].depth_m;
            surface.normal += samples[next].normal;
            surface.albedo += samples[next].albedo;
            surface.fraction += samples[next].fraction;
            ++next;
        }
        const auto count = static_cast<double>(next - first);
        surface.depth_m /= count;
        surface.albedo /= count;
        if (surface.normal.norm() > 0.0) surface.normal.normalize();
        surfaces.push_back(surface);
        first = next;
    }
    return surfaces;
}

/// Depth per width of the surface seen at `i`, as its normal says.
double slope_at(const DepthMap& view, std::size_t i) {
    if (view.normals.empty()) return 0.0;
    const double facing = std::abs(view.normals[i].dot(view.world_from_wall.linear().col(2)));
    if (!(facing > 0.0)) return kSteepest;
    return std::min(kSteepest, std::sqrt(std::max(0.0, 1.0 - facing * facing)) / facing);
}

/// Of the four views half as fine, the fraction that see the surface at (ix, iy) near by.
double seen_at_half(const DepthMap& view, std::size_t ix, std::size_t iy) {
    const std::size_t i = view.index(ix, iy);
    const double width_m = std::max(spacing_m(view.x_m), spacing_m(view.y_m));
    const double near_m = (kReach + 1) * width_m * (1.0 + slope_at(view, i));
    std::array<bool, 4> seen{};
    const auto low = [](std::size_t at) { return at - std::min(at, kReach); };
    for (std::size_t jx = low(ix); jx < std::min(view.x_m.size(), ix + kReach + 1); ++jx) {
        for (std::size_t jy = low(iy); jy < std::min(view.y_m.size(), iy + kReach + 1); ++jy) {
            const double apart_m = view.depth_m[view.index(jx, jy)] - view.depth_m[i];
            if (std::abs(apart_m) <= near_m) seen[2 * (jx % 2) + jy % 2] = true;
        }
    }
    return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / 4.0;
}

double lost_at_half_of(const DepthMap& view) {
    double lost = 0.0;
    std::size_t count = 0;
    for (std::size_t ix = 0; ix < view.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < view.y_m.size(); ++iy) {
            if (!view.is_foreground(view.index(ix, iy))) continue;
            lost += 1.0 - seen_at_half(view, ix, iy);
            ++count;
        }
    }
    return count > 0 ? lost / static_cast<double>(count) : 0.0;
}

/// Means of `per_side` consecutive values.
std::vector<double> cell_centres(const std::vector<double>& parts_m, std::size_t per_side) {
    std::vector<double> centres_m(parts_m.size() / per_side, 0.0);
    for (std::size_t i = 0; i < centres_m.size() * per_side; ++i) {
        centres_m[i / per_side] += parts_m[i] / static_cast<double>(per_side);
    }
    return centres_m;
}

/// Adds the samples of a layer to their columns.
///
/// part   of a column's footprint that a sample stands for
void enter_layer(const DepthMap& layer, double part, TrueSurface& truth) {
    const std::size_t side = truth.per_side;
    for (std::size_t ix = 0; ix < layer.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < layer.y_m.size(); ++iy) {
            const std::size_t i = layer.index(ix, iy);
            if (!layer.is_foreground(i)) continue;
            truth.columns[truth.main.index(ix / side, iy / side)].push_back(
                {layer.depth_m[i],
                 layer.normals.empty() ? Vec3(Vec3::Zero()) : layer.normals[i],
                 layer.albedo.empty() ? 1.0 : layer.albedo[i],
                 part});
        }
    }
}

/// Step of depth from one column to the next along an axis; 0 where the neighbours say nothing.
///
/// before, after   steps from and to the neighbours, NaN where there is none
double step_of(double before, double after, double width_m) {
    if (std::isnan(before) || std::isnan(after)) {
        const double only = std::isnan(before) ? after : before;
        return std::abs(only) <= width_m ? only : 0.0;  // else the edge of another surface
    }
    if (before * after <= 0.0) return 0.0;
    return std::abs(before) < std::abs(after) ? before : after;
}

}  // namespace

TrueSurface::TrueSurface(DepthMap measured)
    : TrueSurface(std::vector<DepthMap>{std::move(measured)}, 1) {}

TrueSurface::TrueSurface(const std::vector<DepthMap>& layers, std::size_t side)
    : main(cell_centres(layers.front().x_m, side), cell_centres(layers.front().y_m, side)),
      per_side(side),
      lost_at_half(lost_at_half_of(layers.front())) {
    const DepthMap& view = layers.front();
    columns.resize(main.depth_m.size());
    for (const DepthMap& layer : layers) {
        const double part = &layer == &view ? 1.0 / static_cast<double>(side * side) : 0.0;
        enter_layer(layer, part, *this);
        PointCloud points = surface_points(layer);
        std::ranges::move(points.positions, std::back_inserter(samples.positions));
        std::ranges::move(points.normals, std::back_inserter(samples.normals));
    }
    const double one_surface_m = kOneSurface * std::max(spacing_m(main.x_m), spacing_m(main.y_m));
    for (auto& column : columns) column = surfaces_of(std::move(column), one_surface_m);
    main.world_from_wall = view.world_from_wall;
    if (!view.normals.empty()) main.normals.assign(columns.size(), Vec3::Zero());
    main.albedo.assign(columns.size(), 0.0);
    main = nearest_surfaces(*this, {});
}

double TrueSurface::covered(std::size_t column) const {
    double sum = 0.0;
    for (const ColumnSurface& surface : columns[column]) sum += surface.fraction;
    return sum;
}

DepthMap nearest_surfaces(const TrueSurface& truth, const DepthMap& found) {
    DepthMap nearest = truth.main;
    const bool same_columns = found.depth_m.size() == truth.columns.size();
    for (std::size_t i = 0; i < truth.columns.size(); ++i) {
        if (truth.columns[i].empty()) continue;
        const bool has_depth = same_columns && found.is_foreground(i);
        const ColumnSurface& surface = *std::min_element(
            truth.columns[i].begin(), truth.columns[i].end(), [&](const auto& a, const auto& b) {
                if (!has_depth) return a.fraction > b.fraction;
                return std::abs(a.depth_m - found.depth_m[i]) <
                       std::abs(b.depth_m - found.depth_m[i]);
            });
        nearest.depth_m[i] = surface.depth_m;
        nearest.albedo[i] = surface.albedo;
        if (!nearest.normals.empty()) nearest.normals[i] = surface.normal;
    }
    return nearest;
}

double spacing_m(const std::vector<double>& centres_m) {
    return std::abs(step_m(centres_m));
}

std::vector<double> parts_of_cells(const std::vector<double>& centres_m, std::size_t per_side) {
    const double part_m = step_m(centres_m) / static_cast<double>(per_side);
    std::vector<double> parts_m;
    for (const double centre_m : centres_m) {
        for (std::size_t k = 0; k < per_side; ++k) {
            parts_m.push_back(centre_m + part_m * (static_cast<double>(k) -
                                                   0.5 * static_cast<double>(per_side - 1)));
        }
    }
    return parts_m;
}

PointCloud dense_points(const DepthMap& depth, std::size_t per_side) {
    DepthMap dense(parts_of_cells(depth.x_m, per_side), parts_of_cells(depth.y_m, per_side));
    dense.world_from_wall = depth.world_from_wall;
    if (!depth.normals.empty()) dense.normals.assign(dense.depth_m.size(), Vec3::Zero());
    const auto depth_at = [&](std::size_t ix, std::size_t iy) {
        const bool is_inside = ix < depth.x_m.size() && iy < depth.y_m.size();
        return is_inside ? depth.depth_m[depth.index(ix, iy)]
                         : std::numeric_limits<double>::quiet_NaN();
    };
    for (std::size_t i = 0; i < dense.x_m.size(); ++i) {
        for (std::size_t j = 0; j < dense.y_m.size(); ++j) {
            const std::size_t ix = i / per_side;
            const std::size_t iy = j / per_side;
            const double here = depth_at(ix, iy);
            if (std::isnan(here)) continue;
            // An index before the first is beyond the last, as indices are unsigned.
            const double along_x = step_of(
                here - depth_at(ix - 1, iy), depth_at(ix + 1, iy) - here, spacing_m(depth.x_m));
            const double along_y = step_of(
                here - depth_at(ix, iy - 1), depth_at(ix, iy + 1) - here, spacing_m(depth.y_m));
            const auto offset = [&](std::size_t at) {
                return (static_cast<double>(at % per_side) + 0.5) / static_cast<double>(per_side) -
                       0.5;
            };
            dense.depth_m[dense.index(i, j)] = here + along_x * offset(i) + along_y * offset(j);
            if (!dense.normals.empty()) {
                dense.normals[dense.index(i, j)] = depth.normals[depth.index(ix, iy)];
            }
        }
    }
    return surface_points(dense);
}

}  // namespace core
