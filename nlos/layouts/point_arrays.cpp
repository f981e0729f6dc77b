// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_points.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Error;
using core::Vec3;

constexpr const char* kCoordinates = "xyz";

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

/// Whether a list of histograms has its points in two axes, filled up at the end to a full square.
bool is_folded_list(const LayoutPoints& layout, const PointAxes& axes) {
    return layout.list_order.size() == 2 && !axes.is_grid();
}

CoordinateArray read_coordinates(const LayoutFiles& files,
                                 const std::string& array,
                                 const LayoutPoints& layout,
                                 const PointAxes& axes) {
    CoordinateArray read;
    read.shape = files.shape(array);
    const std::size_t count = axes.count();
    const std::uint64_t found = total_bytes(read.shape, 1);
    if (is_folded_list(layout, axes) ? found < 3 * count : found != 3 * count) {
        refuse_shape(files, array, read.shape, axes);
    }
    read.values = files.read(array);
    read.strides = strides_of(read.shape, files.first_index_fastest(array));
    read.names = coordinate_axes(layout.axes, read.shape, axes);
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
    if (array.shape.size() == 3 && !axes.is_grid()) {
        const std::size_t slow = array.axis(list_order[0]);
        const std::size_t fast = array.axis(list_order[1]);
        return entry / array.shape[fast] * array.strides[slow] +
               entry % array.shape[fast] * array.strides[fast];
    }
    if (array.shape.size() == 2 && !axes.is_grid()) {
        const std::size_t along = 1 - array.axis(kCoordinates);
        return entry * array.strides[along];
    }
    const std::size_t rows = axes.grid_extents()[1];
    const std::array<std::size_t, 2> index{entry / rows, entry % rows};  // x, y
    const std::size_t x_axis = axes.names[0].back() == 'x' ? 0 : 1;
    if (array.shape.size() == 2) {  // a list that runs as the histograms' two axes do
        const std::size_t along = 1 - array.axis(kCoordinates);
        const std::array<std::size_t, 2> cell{index[x_axis == 0 ? 0 : 1],
                                              index[x_axis == 0 ? 1 : 0]};
        const bool first_fastest =
            list_order.empty() ? axes.first_index_fastest : list_order.back() == axes.names[0];
        const std::size_t number = first_fastest ? cell[0] + axes.extents[0] * cell[1]
                                                 : cell[0] * axes.extents[1] + cell[1];
        return number * array.strides[along];
    }
    return index[0] * array.strides[array.axis(axes.names[x_axis])] +
           index[1] * array.strides[array.axis(axes.names[1 - x_axis])];
}

}  // namespace

std::size_t PointAxes::count() const {
    return total_bytes(extents, 1);
}

bool PointAxes::is_grid() const {
    return names.size() == 2;
}

std::array<std::size_t, 2> PointAxes::grid_extents() const {
    const bool x_first = names[0].back() == 'x';
    return {extents[x_first ? 0 : 1], extents[x_first ? 1 : 0]};
}

std::vector<Vec3> read_vectors(const LayoutFiles& files,
                               const std::string& array,
                               const LayoutPoints& layout,
                               const PointAxes& axes) {
    const CoordinateArray read = read_coordinates(files, array, layout, axes);
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

std::vector<Vec3> read_separate(const LayoutFiles& files,
                                const LayoutPoints& layout,
                                const PointAxes& axes) {
    const std::vector<double> x = files.read(layout.x);
    const std::vector<double> y = files.read(layout.y);
    const std::size_t count = axes.count();
    const auto extents =
        axes.is_grid() ? axes.grid_extents() : std::array<std::size_t, 2>{count, 1};
    std::vector<Vec3> points(count);
    for (std::size_t i = 0; i < count; ++i) {
        const bool are_axes = axes.is_grid() && x.size() == extents[0] && y.size() == extents[1];
        if (!are_axes && (x.size() != count || y.size() != count)) {
            throw Error(files.where(layout.x + ", " + layout.y),
                        fmt::format("hold {} and {} values", x.size(), y.size()),
                        fmt::format("must hold one for each of {} points", count));
        }
        points[i] = {x[are_axes ? i / extents[1] : i], y[are_axes ? i % extents[1] : i], 0.0};
    }
    return points;
}

std::vector<Vec3> points_between(const LayoutFiles& files,
                                 const std::vector<std::string>& corners,
                                 const PointAxes& axes) {
    std::array<Vec3, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::vector<double> values = files.read(corners[i]);
        if (values.size() != 3 || !axes.is_grid()) {
            throw Error(files.where(corners[i]),
                        fmt::format("holds {} values", values.size()),
                        "must be the corner of a grid with axes x and y [m]");
        }
        corner[i] = Vec3(values.data());
    }
    const auto [columns, rows] = axes.grid_extents();
    const auto fraction = [](std::size_t i, std::size_t count) {
        return count > 1 ? static_cast<double>(i) / static_cast<double>(count - 1) : 0.0;
    };
    std::vector<Vec3> points;
    for (std::size_t x = 0; x < columns; ++x) {
        for (std::size_t y = 0; y < rows; ++y) {
            points.push_back(corner[0] + fraction(x, columns) * (corner[1] - corner[0]) +
                             fraction(y, rows) * (corner[2] - corner[0]));
        }
    }
    return points;
}

}  // namespace nlos
