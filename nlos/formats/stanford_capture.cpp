// SPDX-License-Identifier: MIT
#include "nlos/containers/mat5_writer.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/mat_array.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace nlos {
namespace {

using core::Capture;
using core::Error;

// Conventions of the captures published with [OToole2018].
constexpr double kBinSeconds = 4e-12;
constexpr int kDirectReturnBins = 600;
constexpr const char* kName = "Stanford 2018 confocal .mat";

constexpr const char* kOwnAxis = "nlos_axis";

bool recognise_stanford(const std::string& path) {
    return container_of(path) == "matlab-v5" && ArrayReader(path).has_object("rect_data");
}

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

double read_half_width(const std::string& path) {
    const auto width = read_mat_array<double>(path, "width");
    if (width.values.size() != 1 || !std::isfinite(width.values[0]) || width.values[0] <= 0.0) {
        throw Error(
            path + ": width",
            fmt::format(
                "has shape {} and starts with {}", shape_text(width.shape), width.values[0]),
            "must be one positive number [m]");
    }
    return width.values[0];
}

/// What we add to files that we write: axis and unit, which the layout itself fixes.
std::optional<std::vector<double>> read_own_axis(const std::string& path) {
    if (!ArrayReader(path).has_object(kOwnAxis)) return std::nullopt;
    const auto axis = read_mat_array<double>(path, kOwnAxis);
    if (axis.values.size() != 4) {
        throw Error(path + ": " + kOwnAxis,
                    "has shape " + shape_text(axis.shape),
                    "must hold axis start, bin width, 0 for radiance or 1 for counts, and counts "
                    "per radiance or 0");
    }
    return axis.values;
}

void take_own_axis(const std::vector<double>& axis,
                   const CaptureReadSettings& settings,
                   Capture& capture) {
    capture.time_axis.opl_start_m = axis[0];
    capture.time_axis.bin_width_m = settings.bin_width_m.value_or(axis[1]);
    capture.unit = axis[2] == 0.0 ? core::TransientUnit::Radiance : core::TransientUnit::Counts;
    if (axis[3] > 0.0 && std::isfinite(axis[3])) capture.counts_per_radiance = axis[3];
    capture.scene_info[kOwnAxis] = axis;
}

Capture read_stanford(const std::string& path, const CaptureReadSettings& settings) {
    const double half_width_m = read_half_width(path);
    const auto data = read_mat_array<float>(path, "rect_data");
    if (data.shape.size() != 3 || data.shape[0] != data.shape[1] || data.shape[0] < 2) {
        throw Error(path + ": rect_data",
                    "has shape " + shape_text(data.shape),
                    "must have shape (N, N, T) with N of at least 2");
    }
    const std::size_t side = data.shape[0];
    const std::size_t bins = data.shape[2];

    Capture capture;
    capture.scan.pattern = core::ScanPattern::Confocal;
    capture.scan.sensing = scan_points(side, half_width_m);
    capture.scan.illumination = capture.scan.sensing;
    capture.unit = core::TransientUnit::Counts;
    capture.time_axis.num_bins = static_cast<int>(bins);
    capture.time_axis.bin_width_m =
        settings.bin_width_m.value_or(core::opl_from_seconds(kBinSeconds));
    // The direct return, of path length 0, falls into bin 0.
    capture.time_axis.opl_start_m = -0.5 * capture.time_axis.bin_width_m;

    capture.transient = core::Transient(side * side, capture.time_axis.num_bins);
    for (std::size_t i = 0; i < side; ++i) {
        for (std::size_t j = 0; j < side; ++j) {
            const auto histogram = capture.transient.histogram(i * side + j);
            for (std::size_t bin = 0; bin < bins; ++bin) {
                histogram[bin] = data.values[i + side * (j + side * bin)];
            }
        }
    }
    capture.scene_info["original_format"] = kName;
    if (const auto axis = read_own_axis(path)) {
        take_own_axis(*axis, settings, capture);
        return capture;
    }
    capture.notes.push_back(fmt::format("width {} m is half the scanned width", half_width_m));
    capture.notes.push_back(fmt::format(
        "bins of 4 ps are {:.6f} m of path length, counts; the direct return lies in bin 0",
        core::opl_from_seconds(kBinSeconds)));
    return capture;
}

/// The authors drop the direct return's tail; files of ours say where their axis starts.
int default_zero_bins(const Capture& capture) {
    return capture.scene_info.contains(kOwnAxis) ? 0 : kDirectReturnBins;
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
        !capture.scene_info.empty()) {
        losses.emplace_back(
            "variance, orders of bounces, velocities, frames and scene_info are left out");
    }
    return losses;
}

}  // namespace

CaptureFormat stanford_format() {
    return {kName,
            "MATLAB v5 with rect_data and width",
            recognise_stanford,
            read_stanford,
            {".mat"},
            write_stanford,
            default_zero_bins};
}

}  // namespace nlos
