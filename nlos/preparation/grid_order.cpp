// SPDX-License-Identifier: MIT
#include "nlos/preparation/grid_order.h"

#include "nlos/preparation/wall_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace nlos {
namespace {

using core::Vec3;

WallFrame frame_of_points(core::WallPoints points) {
    core::WallScan scan;
    scan.sensing = std::move(points);
    return derive_wall_frame(scan);
}

core::WallPoints reordered(const core::WallPoints& points, const std::vector<std::size_t>& order) {
    core::WallPoints sorted;
    for (const std::size_t i : order) {
        sorted.positions.push_back(points.positions[i]);
        sorted.normals.push_back(points.normals[i]);
    }
    return sorted;
}

template <class Distance>
const Vec3& farthest_point(const std::vector<Vec3>& positions, const Distance& distance) {
    return *std::ranges::max_element(positions, {}, distance);
}

/// The two directions of the grid that the points may fill, the one nearest to the frame's x first,
/// both pointing up the frame's axes. Of a rectangle's corners, one is farthest from any point, the
/// opposite one farthest from it, and a third farthest from the line through both; the longer side
/// is the surer direction.
std::array<Vec3, 2> grid_directions(const std::vector<Vec3>& positions, const core::Mat3& axes) {
    const Vec3& corner = farthest_point(
        positions, [&](const Vec3& p) { return (p - positions.front()).squaredNorm(); });
    const Vec3& opposite =
        farthest_point(positions, [&](const Vec3& p) { return (p - corner).squaredNorm(); });
    const Vec3 diagonal = (opposite - corner).normalized();
    const Vec3& third = farthest_point(
        positions, [&](const Vec3& p) { return (p - corner).cross(diagonal).squaredNorm(); });
    const Vec3 sides[] = {third - corner, opposite - third};
    const Vec3 longer = std::ranges::max(sides, {}, &Vec3::norm).normalized();
    std::array<Vec3, 2> directions{longer, axes.col(2).cross(longer)};
    const auto along = [&](int i, int axis) { return directions[i].dot(axes.col(axis)); };
    if (std::abs(along(0, 0)) < std::abs(along(1, 0))) std::swap(directions[0], directions[1]);
    for (int i = 0; i < 2; ++i) {
        if (along(i, i) < 0.0) directions[i] = -directions[i];
    }
    return directions;
}

/// Of each value, in which of several groups it lies, counted upwards: between groups values lie
/// at least half as far apart as anywhere.
std::vector<std::size_t> groups_of(const std::vector<double>& values) {
    std::vector<std::size_t> ascending(values.size());
    std::iota(ascending.begin(), ascending.end(), std::size_t{0});
    std::ranges::sort(ascending, {}, [&](std::size_t i) { return values[i]; });
    const auto gap_before = [&](std::size_t i) {
        return values[ascending[i]] - values[ascending[i - 1]];
    };
    double widest = 0.0;
    for (std::size_t i = 1; i < values.size(); ++i) widest = std::max(widest, gap_before(i));
    std::vector<std::size_t> groups(values.size(), 0);
    std::size_t group = 0;
    for (std::size_t i = 1; i < values.size(); ++i) {
        if (gap_before(i) > 0.5 * widest) ++group;
        groups[ascending[i]] = group;
    }
    return groups;
}

/// The order in which the points fill a grid with one in each place, and its size.
struct GridOrder {
    std::array<std::size_t, 2> size{};
    std::vector<std::size_t> numbers;
};

std::optional<GridOrder> fill_grid(const std::vector<Vec3>& positions,
                                   const std::array<Vec3, 2>& directions) {
    constexpr std::size_t kNone = static_cast<std::size_t>(-1);
    std::array<std::vector<std::size_t>, 2> places;
    GridOrder order;
    for (int axis = 0; axis < 2; ++axis) {
        std::vector<double> values;
        for (const Vec3& p : positions) {
            values.push_back(directions[axis].dot(p - positions.front()));
        }
        places[axis] = groups_of(values);
        order.size[axis] = 1 + *std::ranges::max_element(places[axis]);
    }
    if (std::min(order.size[0], order.size[1]) < 2 ||
        order.size[0] * order.size[1] != positions.size()) {
        return std::nullopt;
    }
    order.numbers.assign(positions.size(), kNone);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        order.numbers[places[0][i] * order.size[1] + places[1][i]] = i;
    }
    if (std::ranges::find(order.numbers, kNone) != order.numbers.end()) return std::nullopt;
    return order;
}

/// Sorts points into a grid and says how; nothing, and no change, where they stand on one already
/// or fill none.
std::optional<std::vector<std::size_t>> sort_points(core::WallPoints& points) {
    if (points.size() < 4 || frame_of_points(points).grid) return std::nullopt;
    core::WallPoints list = points;
    list.grid.reset();
    const core::Mat3 axes = frame_of_points(list).world_from_wall.linear();
    auto order = fill_grid(points.positions, grid_directions(points.positions, axes));
    if (!order) return std::nullopt;
    core::WallPoints sorted = reordered(points, order->numbers);
    sorted.grid = order->size;
    if (!frame_of_points(sorted).grid) return std::nullopt;
    points = std::move(sorted);
    return std::move(order->numbers);
}

std::vector<std::size_t> stored_order(std::size_t count) {
    std::vector<std::size_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    return numbers;
}

}  // namespace

std::vector<std::size_t> sort_into_grids(core::WallScan& scan) {
    const std::size_t num_sensing = scan.sensing.size();
    const std::vector<std::size_t> sensing =
        sort_points(scan.sensing).value_or(stored_order(num_sensing));
    if (scan.is_confocal()) scan.illumination = scan.sensing;
    if (!scan.is_exhaustive()) return sensing;
    const std::vector<std::size_t> illumination =
        sort_points(scan.illumination).value_or(stored_order(scan.illumination.size()));
    std::vector<std::size_t> pairs;
    for (const std::size_t l : illumination) {
        for (const std::size_t s : sensing) pairs.push_back(l * num_sensing + s);
    }
    return pairs;
}

}  // namespace nlos
