// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_format.h"
#include "nlos/formats/mat_array.h"
#include "nlos/formats/stanford_scan.h"
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

bool recognise_stanford(const std::string& path) {
    return container_of(path) == "matlab-v5" && ArrayReader(path).has_object("rect_data");
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
    capture.scan.sensing = stanford_points(side, half_width_m);
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

}  // namespace

CaptureFormat stanford_format() {
    return {kName,
            "MATLAB v5 with rect_data and width",
            recognise_stanford,
            read_stanford,
            default_zero_bins};
}

}  // namespace nlos
