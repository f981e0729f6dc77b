// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_points.h"

#include "renderer/core/error.h"
#include "renderer/core/nearest_neighbours.h"

#include <Eigen/Eigenvalues>
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

constexpr const char* kCoordinates = "xyz";

bool is_grid(const PointAxes& axes) {
    return axes.names.size() == 2;
}

/// Extents with x before y.
std::array<std::size_t, 2> grid_extents(const PointAxes& axes) {
    const bool x_first = axes.names[0].back() == 'x';
    return {axes.extents[x_first ? 0 : 1], axes.extents[x_first ? 1 : 0]};
}

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
    const auto [columns, rows] = grid_extents(axes);
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

/// An array of three coordinates per point: which of its axes is which.
struct CoordinateArray {
    std::vector<double> values;  ///< in storage order
    std::vector<std::size_t> strides;
    Shape shape;
    std::vector<std::string> names;  ///< of axes

    std::size_t axis(const std::string& name) const {
        return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) -
                                        names.begin());
    }
};

[[noreturn]] void refuse_shape(const LayoutFiles& files,
                               const std::string& array,
                               const Shape& shape,
                               const PointAxes& axes) {
    throw Error(files.where(array),
                "has shape " + shape_text(shape),
                fmt::format("must hold three coordinates for each of {} points", axes.count()));
}

std::vector<std::size_t> strides_of(const Shape& shape, bool first_index_fastest) {
    std::vector<std::size_t> strides(shape.size());
    std::size_t stride = 1;
    for (std::size_t i = 0; i < shape.size(); ++i) {
        const std::size_t axis = first_index_fastest ? i : shape.size() - 1 - i;
        strides[axis] = stride;
        stride *= shape[axis];
    }
    return strides;
}

/// Names for the axes of an array of points: those of the layout, or the coordinates where the
/// extent is 3 and the histograms' own axes elsewhere.
std::vector<std::string> coordinate_axes(std::vector<std::string> names,
                                         const Shape& shape,
                                         const PointAxes& axes) {
    if (!names.empty()) {
        if (axes.reversed) std::reverse(names.begin(), names.end());
        return names;
    }
    const bool last = !shape.empty() && shape.back() == 3;
    names = shape.size() == axes.names.size() + 1 ? axes.names : std::vector<std::string>{"point"};
    names.insert(last ? names.end() : names.begin(), kCoordinates);
    return names;
}

CoordinateArray read_coordinates(const LayoutFiles& files,
                                 const std::string& array,
                                 const std::vector<std::string>& layout_axes,
                                 const PointAxes& axes) {
    CoordinateArray read;
    read.shape = files.shape(array);
    const std::size_t count = axes.count();
    if (std::accumulate(
            read.shape.begin(), read.shape.end(), std::size_t{1}, std::multiplies<>()) !=
        3 * count) {
        refuse_shape(files, array, read.shape, axes);
    }
    read.values = files.read(array);
    read.strides = strides_of(read.shape, files.first_index_fastest(array));
    read.names = coordinate_axes(layout_axes, read.shape, axes);
    // A single point may have any shape; so may trailing extents of 1.
    while (read.names.size() < read.shape.size() && read.shape.back() == 1) read.shape.pop_back();
    if (count == 1) {
        read.shape = {3};
        read.strides = {1};
        read.names = {kCoordinates};
    }
    const std::size_t coordinates = read.axis(kCoordinates);
    if (read.names.size() != read.shape.size() || coordinates >= read.shape.size() ||
        read.shape[coordinates] != 3) {
        refuse_shape(files, array, read.shape, axes);
    }
    return read;
}

/// Where the coordinates of an entry begin in an array of coordinates.
std::size_t offset_of(const CoordinateArray& array,
                      const PointAxes& axes,
                      const std::vector<std::string>& list_order,
                      std::size_t entry) {
    if (array.shape.size() == 1) return 0;
    if (array.shape.size() == 2 && !is_grid(axes)) {
        const std::size_t along = 1 - array.axis(kCoordinates);
        return entry * array.strides[along];
    }
    const std::size_t rows = grid_extents(axes)[1];
    const std::array<std::size_t, 2> index{entry / rows, entry % rows};  // x, y
    const std::size_t x_axis = axes.names[0].back() == 'x' ? 0 : 1;
    if (array.shape.size() == 2) {  // a list that runs as the histograms' two axes do
        const std::size_t along = 1 - array.axis(kCoordinates);
        const std::array<std::size_t, 2> place{index[x_axis == 0 ? 0 : 1],
                                               index[x_axis == 0 ? 1 : 0]};
        const bool first_fastest =
            list_order.empty() ? axes.first_index_fastest : list_order.back() == axes.names[0];
        const std::size_t number = first_fastest ? place[0] + axes.extents[0] * place[1]
                                                 : place[0] * axes.extents[1] + place[1];
        return number * array.strides[along];
    }
    return index[0] * array.strides[array.axis(axes.names[x_axis])] +
           index[1] * array.strides[array.axis(axes.names[1 - x_axis])];
}

std::vector<Vec3> read_vectors(const LayoutFiles& files,
                               const std::string& array,
                               const LayoutPoints& layout,
                               const PointAxes& axes) {
    const CoordinateArray read = read_coordinates(files, array, layout.axes, axes);
    const std::size_t stride = read.strides[read.axis(kCoordinates)];
    std::vector<Vec3> vectors(axes.count(), Vec3::Zero());
    for (std::size_t entry = 0; entry < vectors.size(); ++entry) {
        const std::size_t begin = offset_of(read, axes, layout.list_order, entry);
        for (std::size_t c = 0; c < 3; ++c) {
            const std::string& column = layout.columns[c];
            const double sign = column.front() == '-' ? -1.0 : 1.0;
            vectors[entry][column.back() - 'x'] = sign * read.values[begin + c * stride];
        }
        if (!vectors[entry].allFinite()) {
            throw Error(files.where(array),
                        fmt::format("point {} is not finite", entry),
                        "must be finite numbers [m]");
        }
    }
    return vectors;
}

/// Points from one array of x and one of y: two axes, or two grids.
std::vector<Vec3> read_separate(const LayoutFiles& files,
                                const LayoutPoints& layout,
                                const PointAxes& axes) {
    const std::vector<double> x = files.read(layout.x);
    const std::vector<double> y = files.read(layout.y);
    const std::size_t count = axes.count();
    const auto extents = is_grid(axes) ? grid_extents(axes) : std::array<std::size_t, 2>{count, 1};
    std::vector<Vec3> points(count);
    for (std::size_t i = 0; i < count; ++i) {
        const bool are_axes = is_grid(axes) && x.size() == extents[0] && y.size() == extents[1];
        if (!are_axes && (x.size() != count || y.size() != count)) {
            throw Error(files.where(layout.x + ", " + layout.y),
                        fmt::format("hold {} and {} values", x.size(), y.size()),
                        fmt::format("must hold one for each of {} points", count));
        }
        points[i] = {x[are_axes ? i / extents[1] : i], y[are_axes ? i % extents[1] : i], 0.0};
    }
    return points;
}

/// A grid between corners: its first point, the last along x, the last along y.
std::vector<Vec3> points_between(const LayoutFiles& files,
                                 const std::vector<std::string>& corners,
                                 const PointAxes& axes) {
    std::array<Vec3, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::vector<double> values = files.read(corners[i]);
        if (values.size() != 3 || !is_grid(axes)) {
            throw Error(files.where(corners[i]),
                        fmt::format("holds {} values", values.size()),
                        "must be the corner of a grid with axes x and y [m]");
        }
        corner[i] = Vec3(values.data());
    }
    const auto [columns, rows] = grid_extents(axes);
    const auto share = [](std::size_t i, std::size_t count) {
        return count > 1 ? static_cast<double>(i) / static_cast<double>(count - 1) : 0.0;
    };
    std::vector<Vec3> points;
    for (std::size_t x = 0; x < columns; ++x) {
        for (std::size_t y = 0; y < rows; ++y) {
            points.push_back(corner[0] + share(x, columns) * (corner[1] - corner[0]) +
                             share(y, rows) * (corner[2] - corner[0]));
        }
    }
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

Vec3 plane_normal(const std::vector<Vec3>& points, double* off_plane_m) {
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Vec3& p : points) scatter += (p - mean) * (p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
    const double rms =
        std::sqrt(std::max(0.0, solver.eigenvalues()[0]) / static_cast<double>(points.size()));
    if (off_plane_m != nullptr) *off_plane_m = rms;
    // Points on a line, or one point, have no plane.
    if (solver.eigenvalues()[1] <= 1e-12 * std::max(solver.eigenvalues()[2], 1e-12)) {
        return Vec3::UnitZ();
    }
    return solver.eigenvectors().col(0);
}

}  // namespace

std::size_t PointAxes::count() const {
    return std::accumulate(extents.begin(), extents.end(), std::size_t{1}, std::multiplies<>());
}

std::vector<Vec3> fitted_normals(const std::vector<Vec3>& positions,
                                 const std::optional<Vec3>& towards) {
    constexpr double kFlat_m = 2e-3;  // a wall is painted as flat as that
    constexpr std::size_t kNeighbours = 9;
    double off_plane_m = 0.0;
    std::vector<Vec3> normals(positions.size(), plane_normal(positions, &off_plane_m));
    if (off_plane_m > kFlat_m && positions.size() >= kNeighbours) {
        const auto nearest = core::nearest_neighbours(positions, positions, kNeighbours);
        for (std::size_t i = 0; i < positions.size(); ++i) {
            std::vector<Vec3> patch;
            for (std::size_t k = 0; k < kNeighbours; ++k) {
                patch.push_back(positions[nearest.indices[i * kNeighbours + k]]);
            }
            normals[i] = plane_normal(patch, nullptr);
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
        if (!is_grid(axes)) {
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
    if (is_grid(axes)) {
        const auto extents = grid_extents(axes);
        placed.points.positions = std::move(positions);
        placed.points.normals = std::move(normals);
        placed.points.grid = {extents[0], extents[1]};
        return placed;
    }
    return distinct_points(positions, normals);
}

}  // namespace nlos
