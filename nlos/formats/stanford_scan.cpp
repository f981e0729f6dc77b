// SPDX-License-Identifier: MIT
#include "nlos/formats/stanford_scan.h"

#include "renderer/core/error.h"

#include <fmt/core.h>

namespace nlos {

core::WallPoints stanford_points(std::size_t count, double half_width_m) {
    core::WallPoints points;
    points.grid = {count, count};
    const double pitch_m = 2.0 * half_width_m / static_cast<double>(count - 1);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < count; ++j) {
            points.positions.emplace_back(-half_width_m + pitch_m * static_cast<double>(i),
                                          half_width_m - pitch_m * static_cast<double>(j),
                                          0.0);
        }
    }
    points.normals.assign(points.size(), core::Vec3::UnitZ());
    return points;
}

StanfordScan stanford_scan(const std::string& path, const core::Scan& scan) {
    constexpr double kTolerance_m = 1e-6;  // other files hold single precision
    const auto refuse = [&](const std::string& found) {
        throw core::Error(path,
                          "cannot hold " + found,
                          "must be a confocal square of points on z = 0 around the origin, ends "
                          "included, with path lengths from and to the wall");
    };
    if (scan.camera) refuse("the image of a camera");
    if (scan.pattern != core::ScanPattern::Confocal) {
        refuse(fmt::format("a scan that is {}", enum_name(scan.pattern)));
    }
    if (scan.opl_origin != core::OplOrigin::RelayWall) refuse("path lengths with device legs");
    if (!scan.sensing.grid || (*scan.sensing.grid)[0] != (*scan.sensing.grid)[1] ||
        (*scan.sensing.grid)[0] < 2) {
        refuse("points that are no square grid");
    }
    StanfordScan square;
    square.side = (*scan.sensing.grid)[0];
    square.half_width_m = -scan.sensing.positions.front().x();
    square.y_ascends = scan.sensing.positions.front().y() < scan.sensing.positions.back().y();
    if (!(square.half_width_m > 0.0)) refuse("points whose x does not ascend around 0");
    const core::WallPoints wanted = stanford_points(square.side, square.half_width_m);
    for (std::size_t i = 0; i < square.side; ++i) {
        for (std::size_t j = 0; j < square.side; ++j) {
            const std::size_t pair = square.pair(i, j);
            const core::Vec3& position = wanted.positions[i * square.side + j];
            if ((scan.sensing.positions[pair] - position).norm() > kTolerance_m ||
                (scan.sensing.normals[pair] - core::Vec3::UnitZ()).norm() > kTolerance_m) {
                refuse(fmt::format("point {} where it is", pair));
            }
        }
    }
    return square;
}

}  // namespace nlos
