// SPDX-License-Identifier: MIT
#include "nlos/containers/mat5_writer.h"
#include "nlos/formats/capture_format.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Capture;
using core::Error;

constexpr const char* kOwnAxis = "nlos_axis";

/// Sample points on the wall: linspace with both ends, axis 0 along +x and axis 1 along -y.
core::WallPoints scan_points(std::size_t count, double half_width_m) {
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

/// How a scan's pairs stand in rect_data.
struct SquareScan {
    double half_width_m = 0.0;
    std::size_t side = 0;
    bool y_ascends = true;

    /// The pair at index i along axis 0 (+x) and j along axis 1 (-y).
    std::size_t pair(std::size_t i, std::size_t j) const {
        return i * side + (y_ascends ? side - 1 - j : j);
    }
};

/// What rect_data can hold: a confocal square on the wall z = 0 around the origin.
SquareScan square_scan(const std::string& path, const core::Scan& scan) {
    constexpr double kTolerance_m = 1e-6;  // other files hold single precision
    const auto refuse = [&](const std::string& found) {
        throw Error(path,
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
    SquareScan square;
    square.side = (*scan.sensing.grid)[0];
    square.half_width_m = -scan.sensing.positions.front().x();
    square.y_ascends = scan.sensing.positions.front().y() < scan.sensing.positions.back().y();
    if (!(square.half_width_m > 0.0)) refuse("points whose x does not ascend around 0");
    const core::WallPoints wanted = scan_points(square.side, square.half_width_m);
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

/// Values in the order of the file: [bin][j][i], i fastest.
template <class T>
std::vector<T> to_rect_data(const core::Transient& transient, const SquareScan& square) {
    std::vector<T> data;
    data.reserve(transient.values().size());
    for (std::size_t bin = 0; bin < transient.num_bins(); ++bin) {
        for (std::size_t j = 0; j < square.side; ++j) {
            for (std::size_t i = 0; i < square.side; ++i) {
                data.push_back(static_cast<T>(transient.histogram(square.pair(i, j))[bin]));
            }
        }
    }
    return data;
}

bool fits_uint16(const core::Transient& transient) {
    return std::ranges::all_of(transient.values(), [](float value) {
        return value >= 0.0F && value <= 65535.0F && value == std::trunc(value);
    });
}

std::vector<std::string> write_stanford(const std::string& path,
                                        const Capture& capture,
                                        const CaptureWriteSettings&) {
    const SquareScan square = square_scan(path, capture.scan);
    const bool is_integer = fits_uint16(capture.transient);
    MatVariable data{"rect_data", {square.side, square.side, capture.transient.num_bins()}, {}};
    if (is_integer) {
        data.values = to_rect_data<std::uint16_t>(capture.transient, square);
    } else {
        data.values = to_rect_data<float>(capture.transient, square);
    }
    const std::vector<double> axis{capture.time_axis.opl_start_m,
                                   capture.time_axis.bin_width_m,
                                   capture.unit == core::TransientUnit::Counts ? 1.0 : 0.0,
                                   capture.counts_per_radiance.value_or(0.0)};
    write_mat_file(path,
                   {data,
                    {"width", {1, 1}, std::vector<double>{square.half_width_m}},
                    {kOwnAxis, {1, axis.size()}, axis}});
    std::vector<std::string> losses{
        fmt::format("axis and unit stand in {}, which only this program reads; others assume bins "
                    "of 4 ps from the direct return on",
                    kOwnAxis)};
    if (!is_integer) losses.emplace_back("rect_data is single precision: values are no counts");
    if (capture.variance || !capture.orders.empty() || capture.sequence || capture.velocity ||
        capture.observed || !capture.scene_info.empty()) {
        losses.emplace_back(
            "variance, orders of bounces, velocities, frames, observed bins and scene_info are "
            "left out");
    }
    return losses;
}

}  // namespace

CaptureFormat stanford_format() {
    return {"Stanford 2018 confocal .mat",
            "MATLAB v5 with rect_data and width",
            nullptr,
            nullptr,
            {".mat"},
            write_stanford};
}

}  // namespace nlos
