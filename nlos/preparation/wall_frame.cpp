// SPDX-License-Identifier: MIT
#include "nlos/preparation/wall_frame.h"

#include "renderer/core/principal_axes.h"
#include "renderer/core/settings/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Mat3;
using core::Vec3;

constexpr double kGridTolerance = 0.02;  // of the pitch
constexpr double kSameFrame = 1e-6;      // [m and rad] between frames that are one to people

Vec3 mean_of(const std::vector<Vec3>& points) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& point : points) sum += point;
    return sum / static_cast<double>(std::max<std::size_t>(1, points.size()));
}

/// Mean step of the points of a grid per index along each of its two axes (least squares).
std::array<Vec3, 2> grid_steps(const core::WallPoints& points, const Vec3& center) {
    const auto [nx, ny] = *points.grid;
    std::array<Vec3, 2> steps{Vec3::Zero(), Vec3::Zero()};
    std::array<double, 2> weights{0.0, 0.0};
    for (std::size_t ix = 0; ix < nx; ++ix) {
        for (std::size_t iy = 0; iy < ny; ++iy) {
            const Vec3 offset = points.positions[ix * ny + iy] - center;
            const double u = static_cast<double>(ix) - 0.5 * static_cast<double>(nx - 1);
            const double v = static_cast<double>(iy) - 0.5 * static_cast<double>(ny - 1);
            steps[0] += u * offset;
            steps[1] += v * offset;
            weights[0] += u * u;
            weights[1] += v * v;
        }
    }
    for (int axis = 0; axis < 2; ++axis) {
        if (weights[axis] > 0.0) steps[axis] /= weights[axis];
    }
    return steps;
}

/// The direction in which the points scatter least, or `fallback` when that is not one direction.
Vec3 plane_normal(const std::vector<Vec3>& points, const Vec3& fallback) {
    const core::PrincipalAxes principal = core::principal_axes(points);
    if (!(principal.spread_m[1] > 1e-3 * principal.spread_m[2])) return fallback;
    const Vec3 normal = principal.axes.col(0);
    return normal.dot(fallback) < 0.0 ? Vec3(-normal) : normal;
}

Mat3 frame_of_list(const core::WallPoints& points, const Vec3& mean_normal) {
    Mat3 axes;
    axes.col(2) = plane_normal(points.positions, mean_normal);
    const Vec3 up = std::abs(axes(1, 2)) < 0.99 ? Vec3::UnitY() : Vec3::UnitZ();
    axes.col(0) = up.cross(axes.col(2)).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    return axes;
}

Mat3 frame_of_grid(const std::array<Vec3, 2>& steps, const Vec3& mean_normal) {
    Mat3 axes;
    axes.col(2) = steps[0].cross(steps[1]).normalized();
    const bool is_left_handed = axes.col(2).dot(mean_normal) < 0.0;
    if (is_left_handed) axes.col(2) = -axes.col(2);
    axes.col(0) = steps[0].normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    if (is_left_handed && axes(1, 1) < -1e-6) axes.leftCols<2>() = -axes.leftCols<2>();
    return axes;
}

/// Fills `grid` and the footprint's half cells when the points sit where an even grid has them.
void find_grid(const core::WallPoints& points, const std::array<Vec3, 2>& steps, WallFrame& wall) {
    WallGrid grid;
    grid.size = *points.grid;
    for (int axis = 0; axis < 2; ++axis) {
        const double step = wall.world_from_wall.linear().col(axis).dot(steps[axis]);
        grid.pitch_m[axis] = std::abs(step);
        grid.is_descending[axis] = step < 0.0;
        grid.first_m[axis] = -0.5 * static_cast<double>(grid.size[axis] - 1) * grid.pitch_m[axis];
    }
    // Files store single precision: far from the world's origin that alone moves points.
    const double rounding = 1e-6 * wall.world_from_wall.translation().cwiseAbs().maxCoeff();
    const double tolerance = kGridTolerance * std::min(grid.pitch_m[0], grid.pitch_m[1]) + rounding;
    const core::Transform wall_from_world = wall.world_from_wall.inverse(Eigen::Isometry);
    double bend = 0.0;
    double unevenness = 0.0;
    for (std::size_t ix = 0; ix < grid.size[0]; ++ix) {
        for (std::size_t iy = 0; iy < grid.size[1]; ++iy) {
            const Vec3 found = wall_from_world * points.positions[grid.point(ix, iy)];
            const Vec3 error = found - Vec3(grid.x_m(ix), grid.y_m(iy), 0.0);
            bend = std::max(bend, std::abs(error.z()));
            unevenness = std::max(unevenness, error.head<2>().norm());
        }
    }
    if (bend > tolerance) {
        wall.why_no_grid = fmt::format("wall points {:.3g} mm off their plane", 1e3 * bend);
    } else if (unevenness > tolerance) {
        wall.why_no_grid =
            fmt::format("wall points {:.3g} mm off an even rectangular grid", 1e3 * unevenness);
    } else {
        wall.grid = grid;
    }
}

/// Bounds of all wall points; half a cell is added where a grid says how large a cell is.
void find_footprint(const core::WallScan& scan, WallFrame& wall) {
    const core::Transform wall_from_world = wall.world_from_wall.inverse(Eigen::Isometry);
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300);
    Eigen::Vector2d high = -low;
    for (const auto* points : {&scan.sensing, &scan.illumination}) {
        for (const Vec3& position : points->positions) {
            const Eigen::Vector2d xy = (wall_from_world * position).head<2>();
            low = low.cwiseMin(xy);
            high = high.cwiseMax(xy);
        }
    }
    for (int axis = 0; axis < 2; ++axis) {
        const double margin = wall.grid ? 0.5 * wall.grid->pitch_m[axis] : 0.0;
        wall.min_m[axis] = low[axis] - margin;
        wall.max_m[axis] = high[axis] + margin;
    }
}

}  // namespace

WallFrame derive_wall_frame(const core::WallScan& scan) {
    const core::WallPoints& points = scan.scanned_points();
    const Vec3 center = mean_of(points.positions);
    Vec3 mean_normal = mean_of(points.normals);
    if (!(mean_normal.norm() > 1e-9)) mean_normal = Vec3::UnitZ();
    mean_normal.normalize();

    WallFrame wall;
    wall.world_from_wall.translation() = center;
    std::array<Vec3, 2> steps{Vec3::Zero(), Vec3::Zero()};
    if (points.grid) steps = grid_steps(points, center);
    const bool has_two_axes =
        steps[0].cross(steps[1]).norm() > 1e-6 * steps[0].norm() * steps[1].norm();
    wall.world_from_wall.linear() =
        has_two_axes ? frame_of_grid(steps, mean_normal) : frame_of_list(points, mean_normal);
    if (!points.grid) {
        wall.why_no_grid = "a list of wall points";
    } else if (!has_two_axes) {
        wall.why_no_grid =
            fmt::format("a grid of {} x {} wall points", (*points.grid)[0], (*points.grid)[1]);
    } else {
        find_grid(points, steps, wall);
    }
    find_footprint(scan, wall);
    return wall;
}

bool is_world_frame(const core::Transform& world_from_frame) {
    return world_from_frame.isApprox(core::Transform::Identity(), kSameFrame);
}

std::string describe_wall_frame(const core::Transform& world_from_wall) {
    if (is_world_frame(world_from_wall)) return "the world's";
    const auto text = [](const Vec3& vector) {
        const Vec3 rounded = kSameFrame * (vector / kSameFrame).array().round().matrix();
        return core::vector_text(rounded + Vec3::Zero());  // no -0
    };
    const Mat3 axes = world_from_wall.linear();
    return fmt::format("from {} m of the world, wall x along {}, wall y along {}, depth along {}",
                       text(world_from_wall.translation()),
                       text(axes.col(0)),
                       text(axes.col(1)),
                       text(axes.col(2)));
}

}  // namespace nlos
