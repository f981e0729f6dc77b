// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/mat5_writer.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/matlab_order.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Capture;
using core::WallPoints;

// The struct NLOSDATA of "Convolutional approximations to the general non-line-of-sight imaging
// operator" [Ahn2019], as the authors' backprojection reads it; all numbers are double.
//
//   transient     confocal: (x, y, t), y before x in l; else (n_l, n_s, n_t)
//   l, s          (n_l, 3), (n_s, 3): lit and seen points [m]; confocal: the same
//   times         (1, n_t): path length of each bin's centre [m]
//   delta         bin width [m of path]
//   is_confocal   1 or 0
//   target_dist   distance of the wall from the middle of the hidden scene [m]
//
// The origin is the middle of the hidden scene and the wall stands at z = target_dist. A capture
// does not tell where the scene's middle is: the middle of the axis stands for it. Their world is
// ours after half a turn about the vertical axis: x becomes -x, and z target_dist - z.

/// What NLOSDATA can hold: points on z = 0, with path lengths from and to the wall.
void check_scan(const std::string& path, const core::WallScan& scan) {
    constexpr double kTolerance_m = 1e-6;  // other files hold single precision
    const auto refuse = [&](const std::string& found) {
        throw core::Error(path,
                          "cannot hold " + found,
                          "must be points on the wall z = 0 that looks along z, with path lengths "
                          "from and to the wall");
    };
    if (scan.opl_origin != core::OplOrigin::RelayWall) refuse("path lengths with device segments");
    for (const WallPoints* points : {&scan.illumination, &scan.sensing}) {
        for (std::size_t i = 0; i < points->size(); ++i) {
            if (std::abs(points->positions[i].z()) > kTolerance_m ||
                (points->normals[i] - core::Vec3::UnitZ()).norm() > kTolerance_m) {
                refuse(fmt::format("point {} where it is", i));
            }
        }
    }
}

/// Positions as (N, 3), the point's number fastest.
MatVariable points_variable(const std::string& name,
                            const WallPoints& points,
                            double target_distance_m) {
    std::vector<double> values;
    for (const core::Vec3& position : points.positions) values.push_back(-position.x());
    for (const core::Vec3& position : points.positions) values.push_back(position.y());
    for (const core::Vec3& position : points.positions) {
        values.push_back(target_distance_m - position.z());
    }
    return {name, {points.size(), 3}, std::move(values)};
}

MatVariable number(const std::string& name, double value) {
    return {name, {1, 1}, std::vector<double>{value}};
}

MatVariable transient_variable(const Capture& capture) {
    const core::WallScan& scan = capture.scan.wall();
    std::size_t rows = scan.illumination.size();
    std::size_t columns = scan.sensing.size();
    if (scan.is_confocal()) {
        const auto grid = scan.sensing.grid.value_or(std::array<std::size_t, 2>{columns, 1});
        rows = grid[0];
        columns = grid[1];
    }
    return {"transient",
            {rows, columns, capture.transient.num_bins()},
            to_matlab_order<double>(
                capture.transient, rows, columns, [&](std::size_t row, std::size_t column) {
                    return row * columns + column;
                })};
}

std::vector<std::string> losses(const Capture& capture) {
    std::vector<std::string> sentences{"the unit is left out"};
    const core::WallScan& scan = capture.scan.wall();
    if (!scan.is_confocal() && (scan.sensing.grid || scan.illumination.grid)) {
        sentences.emplace_back("grids become lists of points");
    }
    if (const auto extras = extras_left_out(capture)) sentences.push_back(*extras);
    return sentences;
}

}  // namespace

std::vector<std::string> write_conv_nlos(const std::string& path,
                                         const Capture& capture,
                                         const CaptureWriteSettings&) {
    const core::WallScan& scan = capture.scan.wall(path);
    const core::TimeAxis& axis = capture.time_axis;
    check_scan(path, scan);
    const double middle_m = 0.25 * (axis.opl_start_m + axis.opl_end_m());  // of depths
    const double target_distance_m = std::max(middle_m, axis.bin_width_m);
    std::vector<double> times;
    for (int bin = 0; bin < axis.num_bins; ++bin) times.push_back(axis.bin_center_m(bin));
    const Shape times_shape{1, times.size()};
    std::vector<MatVariable> fields{transient_variable(capture),
                                    points_variable("l", scan.illumination, target_distance_m),
                                    points_variable("s", scan.sensing, target_distance_m),
                                    {"times", times_shape, std::move(times)},
                                    number("delta", axis.bin_width_m),
                                    number("is_confocal", scan.is_confocal() ? 1.0 : 0.0),
                                    number("target_dist", target_distance_m)};
    write_mat_file(path, {{"NLOSDATA", {1, 1}, std::move(fields)}});
    return losses(capture);
}

}  // namespace nlos
