// SPDX-License-Identifier: MIT
#include "nlos/reconstruct_choices.h"

#include "nlos/preparation/wiener_snr.h"
#include "renderer/core/capture/recorded_detector.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace nlos {
namespace {

constexpr std::size_t kDefaultColumns = 64;
constexpr double kBinOfResponse = 0.4;  // standard deviations: widens it by less than 1 %

/// As many bins as keep the range they cover within a quarter of the wall points' distance: finer
/// depth than that no aperture of this sampling resolves, and noise and work shrink with the bins.
/// A gate keeps some bins too. The solver takes wider ones where its response smears more.
int default_merge_bins(const PreparedCapture& prepared, const ReconstructSettings& settings) {
    const core::TimeAxis& axis = prepared.time_axis;
    if (!prepared.wall.grid) return 1;
    double limit_m =
        0.25 * std::min(prepared.wall.grid->pitch_m[0], prepared.wall.grid->pitch_m[1]);
    if (settings.method == Method::Solver && core::is_stated(settings.response)) {
        const auto response = core::make_response(settings.response, "response");
        const double range_m = 0.5 * std::sqrt(core::moments(response).variance_m2);
        limit_m = std::max(limit_m, kBinOfResponse * range_m);
    }
    int num_bins = axis.num_bins;
    for (std::size_t pair = 0; pair < prepared.scan.num_pairs(); ++pair) {
        const int seen = core::observed_range(prepared.observed, pair, axis.num_bins).size();
        if (seen > 0) num_bins = std::min(num_bins, seen);
    }
    int merge = 1;
    while (num_bins / (2 * merge) >= kMinBins && merge * axis.bin_width_m <= limit_m) merge *= 2;
    return merge;
}

/// What takes the stated response off histograms; null when none is stated.
std::shared_ptr<const ResponseDeconvolution> deconvolution_of(const ReconstructSettings& settings,
                                                              const core::TimeAxis& axis) {
    if (!core::is_stated(settings.response)) return {};
    const core::ResponseFilter filter =
        core::sample_response(core::make_response(settings.response, "response"), axis.bin_width_m);
    return std::make_shared<const ResponseDeconvolution>(
        filter, static_cast<std::size_t>(axis.num_bins), settings.response_floor);
}

/// Distance of voxels along z unless set: a bin's range, or what the virtual wave resolves.
double default_depth_step_m(const core::TimeAxis& axis, const ReconstructSettings& settings) {
    const double bin = 0.5 * axis.bin_width_m;
    return uses_wave(settings) ? std::max(bin, *settings.phasor.wavelength_m / 8.0) : bin;
}

/// Half the path lengths that the axis covers once device legs are taken off.
std::array<double, 2> default_z_range(const core::WallScan& scan, const core::TimeAxis& axis) {
    const auto [shortest_leg, longest_leg] = core::device_leg_range_m(scan);
    const double begin = std::max(0.0, 0.5 * (axis.opl_start_m - longest_leg));
    const double end = 0.5 * (axis.opl_end_m() - shortest_leg);
    if (!(end > begin)) {
        throw core::Error("capture",
                          fmt::format("the time axis ends at a range of {:.4g} m", end),
                          "it must reach beyond the wall");
    }
    return {begin, end};
}

}  // namespace

bool uses_wave(const ReconstructSettings& settings) {
    return settings.method == Method::Phasor ||
           (settings.method == Method::Fbp && settings.filter == FbpFilter::Phasor);
}

bool makes_up_for_falloff(const core::WallScan& scan, const ReconstructSettings& settings) {
    return uses_wave(settings) && scan.pattern != core::ScanPattern::Confocal;
}

PreparationPlan choose_preparation(const PreparedCapture& prepared, ReconstructSettings& settings) {
    const core::TimeAxis& axis = prepared.time_axis;
    const bool is_counts = prepared.unit == core::TransientUnit::Counts;
    if (settings.ambient == Ambient::Auto) {
        settings.ambient = is_counts || settings.noise_floor ? Ambient::Subtract : Ambient::Keep;
    }
    if (!settings.merge_bins) settings.merge_bins = default_merge_bins(prepared, settings);
    PreparationPlan plan;
    plan.observed = prepared.observed;
    plan.merge_bins = *settings.merge_bins;
    if (plan.merge_bins > axis.num_bins) {
        throw core::Error("merge_bins",
                          fmt::format("found {}", plan.merge_bins),
                          fmt::format("must not exceed the capture's {} bins", axis.num_bins));
    }
    plan.num_bins = axis.num_bins / plan.merge_bins;
    if (settings.ambient == Ambient::Subtract) {
        if (auto signal = find_signal(prepared.transient(), prepared.observed)) {
            plan.ambient_per_bin = std::move(signal->ambient_per_bin);
            const int end = (signal->end_bin + plan.merge_bins - 1) / plan.merge_bins;
            if (!settings.volume.z_range_m) {
                plan.num_bins = std::clamp(end, std::min(kMinBins, plan.num_bins), plan.num_bins);
            }
        }
        if (settings.noise_floor) {
            plan.ambient_per_bin.assign(prepared.scan.num_pairs(), *settings.noise_floor);
        }
    }
    if (settings.method != Method::Solver) plan.deconvolution = deconvolution_of(settings, axis);
    const bool has_filter = settings.method == Method::Dlct || settings.method == Method::Lct;
    if (has_filter && !settings.snr) {
        settings.snr =
            is_counts
                ? wiener_snr(prepared.scan, axis, prepared.transient(), plan, settings.falloff)
                : kNoiselessSnr;
    }
    return plan;
}

Measurement take_measurement(const PreparedCapture& prepared,
                             const ReconstructSettings& settings,
                             const core::TimeAxis& axis,
                             PreparationPlan& plan) {
    Measurement measurement;
    measurement.is_counts = prepared.unit == core::TransientUnit::Counts;
    measurement.background_per_bin = std::exchange(plan.ambient_per_bin, {});
    for (double& value : measurement.background_per_bin) value *= plan.merge_bins;
    if (core::is_stated(settings.response)) {
        measurement.response = core::sample_response(
            core::make_response(settings.response, "response"), axis.bin_width_m);
    }
    return measurement;
}

void choose_axes(const core::WallScan& scan,
                 const core::TimeAxis& axis,
                 const WallFrame& wall,
                 ReconstructSettings& settings,
                 VolumeAxes& axes) {
    VolumeSettings& volume = settings.volume;
    if (!volume.z_range_m) volume.z_range_m = default_z_range(scan, axis);
    const double depth = (*volume.z_range_m)[1] - (*volume.z_range_m)[0];
    std::array<double, 2> low = wall.min_m;
    std::array<double, 2> high = wall.max_m;
    for (int i = 0; i < 2 && wall.grid; ++i) {  // other points may lie outside the grid
        low[i] = wall.grid->first_m[i] - 0.5 * wall.grid->pitch_m[i];
        high[i] = low[i] + static_cast<double>(wall.grid->size[i]) * wall.grid->pitch_m[i];
    }
    const double size = std::max(high[0] - low[0], high[1] - low[1]);
    for (int i = 0; i < 2; ++i) {  // points on a line, or one point: a square, or as wide as deep
        if (high[i] - low[i] > 1e-3 * size && size > 0.0) continue;
        const double center = 0.5 * (low[i] + high[i]);
        low[i] = center - 0.5 * (size > 0.0 ? size : depth);
        high[i] = center + 0.5 * (size > 0.0 ? size : depth);
    }
    if (!volume.voxels) {
        const std::array<std::size_t, 2> columns =
            wall.grid ? wall.grid->size : std::array{kDefaultColumns, kDefaultColumns};
        const double step = default_depth_step_m(axis, settings);
        volume.voxels = {
            static_cast<int>(columns[0]),
            static_cast<int>(columns[1]),
            static_cast<int>(std::clamp(std::round(depth / step), 1.0, double{kMaxVoxelsPerAxis}))};
    }
    const auto [nx, ny, nz] = *volume.voxels;
    axes.x_m = cell_centers(low[0], high[0], static_cast<std::size_t>(nx));
    axes.y_m = cell_centers(low[1], high[1], static_cast<std::size_t>(ny));
    axes.z_m =
        cell_centers((*volume.z_range_m)[0], (*volume.z_range_m)[1], static_cast<std::size_t>(nz));
    axes.world_from_wall = wall.world_from_wall;
}

MethodChoice choose_and_enter_method(const core::Capture& capture,
                                     ReconstructSettings& settings,
                                     PreparedCapture& prepared) {
    if (!settings.solver.spot_m) {
        settings.solver.spot_m = core::recorded_spot_m(capture).value_or(0.0);
    }
    ReconstructSettings with_response = settings;
    if (settings.method == Method::Auto && !core::is_stated(settings.response)) {
        with_response.response = core::recorded_response(capture).value_or(settings.response);
    }
    MethodChoice choice = choose_method(with_response, prepared);
    if (choice.method == Method::Solver) settings.response = with_response.response;
    settings.method = choice.method;
    return choice;
}

}  // namespace nlos
