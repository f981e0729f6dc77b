// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_points.h"

#include "renderer/core/error.h"
#include "renderer/core/nearest_neighbours.h"
#include "renderer/core/principal_axes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace nlos {
namespace {

using core::Error;
using core::Vec3;

/// Extents along x and y [m] between first and last point, and the pitch, of a centred grid.
struct GridSize {
    double extent_m;
    double pitch_m;
};

std::optional<double> element_of(const LayoutFiles& files,
                                 const std::vector<LayoutNumber>& list,
                                 std::size_t axis,
                                 const std::string& setting) {
    if (list.empty()) return std::nullopt;
    return files.number(list[std::min(axis, list.size() - 1)], setting);
}

GridSize grid_size(const LayoutFiles& files,
                   const LayoutGrid& grid,
                   std::size_t axis,
                   std::size_t count,
                   const CaptureReadSettings& settings) {
    const auto steps = static_cast<double>(std::max<std::size_t>(count, 2) - 1);
    if (settings.wall_size_m) {
        const double extent_m = (*settings.wall_size_m)[axis];
        return {extent_m, extent_m / steps};
    }
    if (!grid.pitch_m.empty()) {
        const double pitch_m = settings.pitch_m
                                   ? *settings.pitch_m
                                   : *element_of(files, grid.pitch_m, axis, "capture.pitch_m");
        return {pitch_m * steps, pitch_m};
    }
    const double size_m =
        !grid.size_m.empty()
            ? *element_of(files, grid.size_m, axis, "capture.wall_size_m")
            : 2.0 * *element_of(files, grid.half_size_m, axis, "capture.wall_size_m");
    if (grid.samples == GridSamples::CellCentres) {
        const double pitch_m = size_m / static_cast<double>(count);
        return {pitch_m * steps, pitch_m};
    }
    return {size_m, size_m / steps};
}

/// Coordinates along one axis of a grid around 0; a single point stands at 0.
std::vector<double> centred_coordinates(std::size_t count, GridSize size, GridDirection direction) {
    if (!(size.pitch_m > 0.0) || !std::isfinite(size.extent_m)) {
        throw Error("grid of wall points",
                    fmt::format("has a pitch of {} m", size.pitch_m),
                    "must be a positive number");
    }
    const double sign = direction == GridDirection::Increasing ? 1.0 : -1.0;
    std::vector<double> coordinates(count, 0.0);
    if (count == 1) return coordinates;
    for (std::size_t i = 0; i < count; ++i) {
        coordinates[i] = sign * (size.pitch_m * static_cast<double>(i) - 0.5 * size.extent_m);
    }
    return coordinates;
}

core::WallPoints make_grid(const LayoutFiles& files,
                           const LayoutGrid& grid,
                           const PointAxes& axes,
                           const CaptureReadSettings& settings) {
    const auto [columns, rows] = axes.grid_extents();
    const auto x =
        centred_coordinates(columns, grid_size(files, grid, 0, columns, settings), grid.x);
    const auto y = centred_coordinates(rows, grid_size(files, grid, 1, rows, settings), grid.y);
    core::WallPoints points;
    points.grid = {columns, rows};
    for (const double px : x) {
        for (const double py : y) points.positions.emplace_back(px, py, 0.0);
    }
    points.normals.assign(points.size(), Vec3::UnitZ());
    return points;
}

/// Coordinates that differ by less than rounding in single precision count as one.
struct Rounded {
    double step_m;
    std::int64_t operator()(double value) const { return std::llround(value / step_m); }
};

Rounded rounding_of(const std::vector<Vec3>& positions) {
    double largest = 1e-6;
    for (const Vec3& p : positions) largest = std::max(largest, p.cwiseAbs().maxCoeff());
    return {1e-5 * largest};
}

/// The different points of a list; as a grid, x slowest, when they fill one on a plane z = const.
PlacedPoints distinct_points(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals) {
    const Rounded rounded = rounding_of(positions);
    std::map<std::array<std::int64_t, 3>, std::size_t> first;  // in order of x, then y
    std::set<std::int64_t> columns;
    std::set<std::int64_t> rows;
    std::set<std::int64_t> layers;
    std::vector<std::array<std::int64_t, 3>> keys;
    for (const Vec3& p : positions) {
        keys.push_back({rounded(p.x()), rounded(p.y()), rounded(p.z())});
        first.try_emplace(keys.back(), keys.size() - 1);
        columns.insert(keys.back()[0]);
        rows.insert(keys.back()[1]);
        layers.insert(keys.back()[2]);
    }
    PlacedPoints placed;
    if (layers.size() == 1 && columns.size() * rows.size() == first.size()) {
        placed.points.grid = {columns.size(), rows.size()};
    }
    std::vector<std::size_t> order;
    for (const auto& [key, entry] : first) order.push_back(entry);
    if (!placed.points.grid) std::sort(order.begin(), order.end());
    for (std::size_t number = 0; number < order.size(); ++number) {
        placed.points.positions.push_back(positions[order[number]]);
        placed.points.normals.push_back(normals[order[number]]);
        first[keys[order[number]]] = number;
    }
    for (const auto& key : keys) placed.of_entry.push_back(first.at(key));
    return placed;
}

// Points on a line, or one point, have no plane.
Vec3 plane_normal(const core::PrincipalAxes& points) {
    const Vec3& spread_m = points.spread_m;
    return spread_m[1] > 1e-6 * std::max(spread_m[2], 1e-6) ? Vec3(points.axes.col(0))
                                                            : Vec3::UnitZ();
}

}  // namespace

std::vector<Vec3> fitted_normals(const std::vector<Vec3>& positions,
                                 const std::optional<Vec3>& towards) {
    constexpr double kFlat_m = 2e-3;  // a wall is painted as flat as that
    constexpr std::size_t kNeighbours = 9;
    const core::PrincipalAxes all = core::principal_axes(positions);
    std::vector<Vec3> normals(positions.size(), plane_normal(all));
    if (all.spread_m[0] > kFlat_m && positions.size() >= kNeighbours) {
        const auto nearest = core::nearest_neighbours(positions, positions, kNeighbours);
        for (std::size_t i = 0; i < positions.size(); ++i) {
            std::vector<Vec3> patch;
            for (std::size_t k = 0; k < kNeighbours; ++k) {
                patch.push_back(positions[nearest.indices[i * kNeighbours + k]]);
            }
            normals[i] = plane_normal(core::principal_axes(patch));
        }
    }
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const double side = towards ? normals[i].dot(*towards - positions[i]) : normals[i].z();
        if (side < 0.0) normals[i] = -normals[i];
    }
    return normals;
}

PlacedPoints place_points(const LayoutFiles& files,
                          const LayoutPoints& layout,
                          const PointAxes& axes,
                          const CaptureReadSettings& settings,
                          const std::optional<Vec3>& towards,
                          const std::string& key) {
    PlacedPoints placed;
    placed.of_entry.resize(axes.count());
    std::iota(placed.of_entry.begin(), placed.of_entry.end(), std::size_t{0});
    if (layout.grid) {
        if (!axes.is_grid()) {
            throw Error(files.where(key + ".grid"),
                        fmt::format("is for histograms along {} axes", axes.names.size()),
                        "must be a list of points, or the histograms have axes x and y");
        }
        placed.points = make_grid(files, *layout.grid, axes, settings);
        return placed;
    }
    std::vector<Vec3> positions;
    if (!layout.position_m.empty()) {
        positions.assign(axes.count(), Vec3(layout.position_m.data()));
    } else if (!layout.corners.empty()) {
        positions = points_between(files, layout.corners, axes);
    } else if (!layout.array.empty()) {
        positions = read_vectors(files, layout.array, layout, axes);
    } else {
        positions = read_separate(files, layout, axes);
    }
    if (layout.pitch_m.is_given()) {
        const double pitch_m =
            settings.pitch_m ? *settings.pitch_m : *files.number(layout.pitch_m, "capture.pitch_m");
        for (Vec3& p : positions) p *= pitch_m;
    }
    if (const auto z = files.number(layout.wall_z_m, "capture.wall_z_m")) {
        for (Vec3& p : positions) p.z() = *z - p.z();
    }
    std::vector<Vec3> normals;
    if (!layout.normals.empty() && files.has(layout.normals)) {
        normals = read_vectors(files, layout.normals, layout, axes);
        for (Vec3& n : normals) n = n.norm() > 0.0 ? Vec3(n.normalized()) : Vec3(Vec3::UnitZ());
    } else {
        normals = fitted_normals(positions, towards);
    }
    if (axes.is_grid()) {
        const auto extents = axes.grid_extents();
        placed.points.positions = std::move(positions);
        placed.points.normals = std::move(normals);
        placed.points.grid = {extents[0], extents[1]};
        return placed;
    }
    return distinct_points(positions, normals);
}

}  // namespace nlos
