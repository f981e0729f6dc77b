// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_reader.h"
#include "nlos/formats/mat_file.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Capture;
using core::Error;

// Conventions of the captures published with [OToole2018].
constexpr double kBinSeconds = 4e-12;
constexpr int kDirectReturnBins = 600;

bool recognise(const std::string& path) {
    if (!is_mat5_file(path)) return false;
    const auto names = mat_variable_names(path);
    return std::find(names.begin(), names.end(), "rect_data") != names.end();
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

Capture read(const std::string& path, const CaptureReadSettings& settings) {
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
    capture.scene_info["original_format"] = "Stanford 2018 confocal .mat";
    capture.notes.push_back(fmt::format("width {} m is half the scanned width", half_width_m));
    capture.notes.push_back(fmt::format(
        "bins of 4 ps are {:.6f} m of path length, counts; the direct return lies in bin 0",
        core::opl_from_seconds(kBinSeconds)));
    return capture;
}

}  // namespace

const CaptureReader kStanfordReader{"Stanford 2018 confocal .mat",
                                    "MATLAB v5 with rect_data and width",
                                    recognise,
                                    read,
                                    kDirectReturnBins};

}  // namespace nlos
