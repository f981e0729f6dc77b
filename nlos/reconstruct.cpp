// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"

#include "nlos/methods/backprojection.h"
#include "nlos/methods/directional_light_cone_transform.h"
#include "nlos/methods/filtered_backprojection.h"
#include "nlos/methods/fk_migration.h"
#include "nlos/methods/light_cone_transform.h"
#include "nlos/methods/method_choice.h"
#include "nlos/methods/phasor_field.h"
#include "nlos/methods/total_variation.h"
#include "nlos/methods/virtual_wave.h"
#include "nlos/preparation/capture_check.h"
#include "nlos/preparation/histogram_preparation.h"
#include "nlos/preparation/memory_limit.h"
#include "nlos/preparation/prepared_capture.h"
#include "nlos/preparation/second_capture.h"
#include "nlos/preparation/wiener_snr.h"
#include "nlos/reconstruction/surface.h"
#include "renderer/core/process.h"
#include "renderer/core/recorded_detector.h"
#include "renderer/core/stopwatch.h"

#include <fmt/format.h>

#include <cmath>

namespace nlos {
namespace {

constexpr std::size_t kDefaultColumns = 64;
constexpr std::size_t kMaxSlabs = 64;  // each repeats a part of the work

/// As many bins as keep the range they cover within a quarter of the wall points' distance: finer
/// depth than that no aperture of this sampling resolves, and noise and work shrink with the bins.
/// A gate keeps some bins too.
int default_merge_bins(const PreparedCapture& prepared) {
    const core::TimeAxis& axis = prepared.time_axis;
    if (!prepared.wall.grid) return 1;
    const double limit_m =
        0.25 * std::min(prepared.wall.grid->pitch_m[0], prepared.wall.grid->pitch_m[1]);
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

/// Fills in merge_bins, ambient and, where a method has it, snr, and says what becomes of the
/// histograms.
PreparationPlan choose_preparation(const PreparedCapture& prepared, ReconstructSettings& settings) {
    const core::TimeAxis& axis = prepared.time_axis;
    const bool is_counts = prepared.unit == core::TransientUnit::Counts;
    if (settings.ambient == Ambient::Auto) {
        settings.ambient = is_counts || settings.noise_floor ? Ambient::Subtract : Ambient::Keep;
    }
    if (!settings.merge_bins) settings.merge_bins = default_merge_bins(prepared);
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
    plan.deconvolution = deconvolution_of(settings, axis);
    const bool has_filter = settings.method == Method::Dlct ||
                            (settings.method == Method::Lct && settings.prior == Prior::None);
    if (has_filter && !settings.snr) {
        settings.snr =
            is_counts
                ? wiener_snr(prepared.scan, axis, prepared.transient(), plan, settings.falloff)
                : kNoiselessSnr;
    }
    return plan;
}

bool uses_wave(const ReconstructSettings& settings) {
    return settings.method == Method::Phasor ||
           (settings.method == Method::Fbp && settings.filter == FbpFilter::Phasor);
}

/// Whether histograms are multiplied by range^power against the falloff of light. A confocal scan
/// lights every voxel from all over the wall; there the factor would only let far wall points
/// outvote near ones.
bool makes_up_for_falloff(const core::Scan& scan, const ReconstructSettings& settings) {
    return uses_wave(settings) && scan.pattern != core::ScanPattern::Confocal;
}

/// Distance of voxels along z unless set: a bin's range, or what the virtual wave resolves.
double default_depth_step_m(const core::TimeAxis& axis, const ReconstructSettings& settings) {
    const double bin = 0.5 * axis.bin_width_m;
    return uses_wave(settings) ? std::max(bin, *settings.phasor.wavelength_m / 8.0) : bin;
}

/// Half the path lengths that the axis covers once device legs are taken off.
std::array<double, 2> default_z_range(const core::Scan& scan, const core::TimeAxis& axis) {
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

/// Columns at the scan's points or evenly over its footprint, depths at the bins' ranges.
void choose_axes(const core::Scan& scan,
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

/// A method that knows normals knows them better than a plane through neighbouring columns does.
void take_normals(const Volume& volume, core::DepthMap& depth) {
    for (std::size_t i = 0; i < volume.normals.size(); ++i) {
        if (!depth.is_foreground(i)) continue;
        depth.normals[i] = depth.world_from_wall.linear() * volume.normals[i].cast<double>();
    }
}

/// Waves and f-k migration give squares. The deviations of depth are those that simulated surfaces
/// showed without noise, see nlos/README.md.
VolumeErrors volume_errors(const ReconstructSettings& settings) {
    if (uses_wave(settings)) return {VolumeScale::Power, 0.5};
    switch (settings.method) {
        case Method::Fk:
            return {VolumeScale::Power, 0.28};
        case Method::Fbp:
            return {VolumeScale::Amplitude, 0.2};
        case Method::Bp:
            return {VolumeScale::Amplitude, 0.5};
        default:
            return {VolumeScale::Amplitude, 0.12};
    }
}

/// Takes depths, what is known of them and points from the volume and, where the noise is known,
/// that of the scene measured again.
void take_surface(const Volume* again, Reconstruction& result) {
    Surface surface = find_surface(
        result.volume, again, volume_errors(result.settings), result.settings.mask_threshold);
    result.depth = std::move(surface.depth);
    result.surface_probability = std::move(surface.probability);
    result.depth_sigma_m = std::move(surface.depth_sigma_m);
    take_normals(result.volume, result.depth);
    result.points = surface_points(result.depth);
}

/// A reconstruction method: what it computes, and the memory that takes on top of its input
/// [bytes], both with as many slabs of work one after another.
struct MethodFunctions {
    using Run = Volume(const MethodInput&, const ReconstructSettings&, std::size_t num_slabs);
    using Bytes = double(const MethodInput&, const ReconstructSettings&, std::size_t num_slabs);
    Run* run;
    Bytes* bytes;
};

MethodFunctions functions_of(const ReconstructSettings& settings) {
    switch (settings.method) {
        case Method::Lct:
            if (settings.prior == Prior::Tv) {
                return {total_variation_light_cone_transform, total_variation_bytes};
            }
            return {light_cone_transform, light_cone_transform_bytes};
        case Method::Dlct:
            return {directional_light_cone_transform, directional_light_cone_transform_bytes};
        case Method::Fk:
            return {fk_migration, fk_migration_bytes};
        case Method::Phasor:
            return {phasor_field, phasor_field_bytes};
        case Method::Fbp:
            if (settings.filter == FbpFilter::Phasor) {
                return {phasor_backprojection, phasor_backprojection_bytes};
            }
            return {laplacian_backprojection, laplacian_backprojection_bytes};
        case Method::Auto:
        case Method::Bp:
            break;
    }
    return {backproject, backproject_bytes};
}

/// As few slabs as fit into memory; 1 when none do.
std::size_t choose_slabs(const MethodInput& input,
                         const ReconstructSettings& settings,
                         double other_bytes) {
    const double available = memory_budget(settings.memory_gb);
    for (std::size_t num_slabs = 1; num_slabs <= kMaxSlabs; ++num_slabs) {
        if (other_bytes + functions_of(settings).bytes(input, settings, num_slabs) <= available)
            return num_slabs;
    }
    return 1;
}

/// Says what will run and what it needs.
void announce(const Reconstruction& result, std::size_t num_slabs, const core::Progress& progress) {
    if (!progress.announce) return;
    progress.announce(fmt::format("{}: {}; needs {:.2f} GB of memory{}",
                                  result.method,
                                  result.reason,
                                  1e-9 * result.stated_bytes,
                                  num_slabs > 1 ? fmt::format(" in {} slabs", num_slabs) : ""));
}

}  // namespace

Reconstruction reconstruct(const core::Capture& capture,
                           const ReconstructSettings& settings,
                           const core::Progress& progress) {
    const core::Stopwatch watch;
    validate(settings);
    core::validate(capture, "capture");
    if (capture.scan.camera) {
        throw core::Error(
            "capture", "found the image of a camera", "must be a scan of points on a relay wall");
    }

    Reconstruction result;
    result.settings = settings;
    result.settings.response = core::resolve_response(settings.response, capture, "response");
    result.warnings = capture_warnings(capture);
    for (std::string& text : core::detector_warnings(capture, result.settings.response)) {
        result.warnings.push_back(std::move(text));
    }
    PreparedCapture prepared = crop_capture(capture, settings.crop);
    const MethodChoice choice = choose_method(settings, prepared);
    result.settings.method = choice.method;
    result.method = core::enum_name(choice.method);
    result.reason = choice.reason;

    const PreparationPlan plan = choose_preparation(prepared, result.settings);
    core::TimeAxis axis = prepared.time_axis;
    axis.bin_width_m *= plan.merge_bins;
    axis.num_bins = plan.num_bins;
    if (uses_wave(result.settings) && !result.settings.phasor.wavelength_m) {
        result.settings.phasor.wavelength_m =
            default_wavelength_m(prepared.scan, prepared.wall, axis);
    }
    VolumeAxes axes;
    choose_axes(prepared.scan, axis, prepared.wall, result.settings, axes);

    const bool is_ready = plan.num_bins == prepared.time_axis.num_bins &&
                          plan.ambient_per_bin.empty() && !plan.deconvolution &&
                          !makes_up_for_falloff(prepared.scan, result.settings);
    core::ObservedBins observed = prepared_observed(plan);
    core::simplify(observed, axis.num_bins);
    if (auto warning = unobserved_warning(result.settings, observed, axis.num_bins)) {
        result.warnings.push_back(std::move(*warning));
    }
    const bool has_noise = knows_its_noise(capture);
    const core::Progress first_run = progress.part(0.0, has_noise ? 0.5 : 1.0);
    const core::Progress second_run = progress.part(0.5, 1.0);
    const auto input_with = [&](const core::Transient& transient, const core::Progress& part) {
        return MethodInput{prepared.scan,
                           axis,
                           transient,
                           prepared.wall,
                           axes,
                           *result.settings.volume.z_range_m,
                           part,
                           observed ? &*observed : nullptr,
                           prepared.unobserved_before_m};
    };
    double prepared_bytes =
        is_ready && !has_noise
            ? 0.0
            : 4.0 * static_cast<double>(prepared.scan.num_pairs()) * axis.num_bins;
    if (has_noise) {  // the scene measured again, and its volume
        prepared_bytes += 4.0 * static_cast<double>(capture.transient.values().size()) +
                          prepared.own_bytes() + 4.0 * static_cast<double>(axes.num_voxels());
    }
    const MethodFunctions method = functions_of(result.settings);
    const MethodInput unprepared = input_with(prepared.transient(), first_run);
    const std::size_t num_slabs = choose_slabs(unprepared, result.settings, prepared_bytes);
    const double work_bytes = prepared_bytes + method.bytes(unprepared, result.settings, num_slabs);
    require_memory(work_bytes, settings.memory_gb);
    result.stated_bytes = work_bytes + prepared.own_bytes();
    announce(result, num_slabs, progress);
    check_stop(progress);
    const auto prepare = [&](const core::Transient& transient) {
        core::Transient histograms = prepare_histograms(transient, plan);
        if (makes_up_for_falloff(prepared.scan, result.settings)) {
            multiply_by_range(prepared.scan, axis, falloff_power(settings.falloff), histograms);
        }
        return histograms;
    };
    core::Transient histograms;
    if (!is_ready) histograms = prepare(prepared.transient());
    result.volume = method.run(input_with(is_ready ? prepared.transient() : histograms, first_run),
                               result.settings,
                               num_slabs);
    std::optional<Volume> again;
    if (const auto second = measure_again(capture)) {
        PreparedCapture prepared_again = crop_capture(*second, settings.crop);
        if (!prepared.conversion.empty()) convert_to_confocal(prepared_again);
        histograms = prepare(prepared_again.transient());
        again = method.run(input_with(histograms, second_run), result.settings, num_slabs);
    }
    take_surface(again ? &*again : nullptr, result);
    result.seconds = watch.seconds();
    result.peak_bytes = core::peak_rss_bytes();
    return result;
}

}  // namespace nlos
