// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"

#include "nlos/preparation/capture_faults.h"
#include "nlos/preparation/memory_limit.h"
#include "nlos/preparation/place_resolution.h"
#include "nlos/reconstruct_choices.h"
#include "nlos/setup_uncertainty.h"
#include "renderer/core/statistics.h"
#include "renderer/core/stopwatch.h"
#include "renderer/core/system/process.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nlos {
namespace {

constexpr std::size_t kMaxSlabs = 64;  // each repeats a part of the work

/// progress   must outlive the result, as must all others
MethodInput input_of(const ReconstructionPlan& plan,
                     const core::Transient& histograms,
                     const ReconstructSettings& settings,
                     const core::Progress& progress) {
    return {plan.prepared.scan,
            plan.time_axis,
            histograms,
            plan.prepared.wall,
            plan.axes,
            *settings.volume.z_range_m,
            progress,
            plan.observed ? &*plan.observed : nullptr,
            plan.prepared.unobserved_before_m,
            plan.measurement,
            plan.dark_from_m};
}

/// Memory that is taken beside a method's own [bytes].
double other_bytes(const core::Capture& capture, const ReconstructionPlan& plan) {
    const bool has_noise = plan.knows_noise(capture);
    double bytes = 0.0;
    if (plan.changes_histograms() || has_noise) {
        bytes = 4.0 * static_cast<double>(plan.prepared.scan.num_pairs()) * plan.time_axis.num_bins;
    }
    if (has_noise) {  // the scene measured again, and its volume
        bytes += 4.0 * static_cast<double>(capture.transient.values().size()) +
                 plan.prepared.own_bytes() + 4.0 * static_cast<double>(plan.axes.num_voxels());
    }
    return bytes;
}

/// Claims memory for as few slabs as fit into it, and says what will run and what it needs.
///
/// returns   the number of slabs
/// throws    core::Failure when memory does not suffice
std::size_t claim_memory(const core::Capture& capture,
                         const ReconstructionPlan& plan,
                         const core::Progress& progress,
                         Reconstruction& result) {
    const ReconstructSettings& settings = result.settings;
    const MethodInput input = input_of(plan, plan.prepared.transient(), settings, progress);
    const double beside = other_bytes(capture, plan);
    const auto bytes_in = [&](std::size_t num_slabs) {
        return beside + traits_of(settings).bytes(input, settings, num_slabs);
    };
    const double available = memory_budget(settings.memory_gb);
    std::size_t num_slabs = 1;
    while (num_slabs <= kMaxSlabs && !(bytes_in(num_slabs) <= available)) ++num_slabs;
    if (num_slabs > kMaxSlabs) num_slabs = 1;
    const double bytes = bytes_in(num_slabs);
    require_memory(bytes, settings.memory_gb);
    result.estimated_bytes = bytes + plan.prepared.own_bytes();
    if (progress.announce) {
        progress.announce(fmt::format("{}: {}; needs {:.2f} GB of memory{}",
                                      result.method,
                                      result.reason,
                                      1e-9 * result.estimated_bytes,
                                      num_slabs > 1 ? fmt::format(" in {} slabs", num_slabs) : ""));
    }
    check_stop(progress);
    return num_slabs;
}

/// The histograms that the method gets; nothing where those of the capture are.
std::optional<core::Transient> prepare(const ReconstructionPlan& plan,
                                       const core::Transient& transient) {
    if (!plan.changes_histograms()) return std::nullopt;
    core::Transient histograms = prepare_histograms(transient, plan.preparation);
    if (plan.range_power != 0.0) {
        multiply_by_range(plan.prepared.scan, plan.time_axis, plan.range_power, histograms);
    }
    return histograms;
}

/// Enters how light falls off: as the data say where they do, else diffuse.
void enter_falloff(const MethodInput& input, FalloffTrial trial, Reconstruction& result) {
    ReconstructSettings& settings = result.settings;
    if (settings.falloff != Falloff::Auto) return;
    settings.falloff = Falloff::Diffuse;
    const MethodTraits& method = traits_of(settings);
    if (!method.choose_falloff) return;
    if (auto choice = method.choose_falloff(input, settings, trial)) {
        settings.falloff = choice->falloff;
        result.findings.push_back(std::move(choice->reason));
    }
}

/// The volume of the same scene measured again; nothing where the noise is not known.
std::optional<Volume> measured_again(const core::Capture& capture,
                                     const ReconstructionPlan& plan,
                                     const ReconstructSettings& settings,
                                     std::size_t num_slabs,
                                     const core::Progress& progress) {
    const std::optional<core::Capture> second = measure_again(capture, plan.preparation.photon);
    if (!second) return std::nullopt;
    PreparedCapture prepared = crop_capture(*second, settings.crop);
    if (!plan.prepared.conversion.empty()) convert_to_confocal(prepared);
    const std::optional<core::Transient> own = prepare(plan, prepared.transient());
    return traits_of(settings).run(
        input_of(plan, own ? *own : prepared.transient(), settings, progress), settings, num_slabs);
}

/// Leaves out surfaces at places that the scan tells from no other across the volume's width:
/// confident as they look, they may be anywhere on a shell.
///
/// middle_m   depth to look at in columns without a surface
/// returns    per column, whether the scan tells something there
std::vector<std::uint8_t> leave_out_untold(const PreparedCapture& prepared,
                                           double middle_m,
                                           Surface& surface) {
    const PlaceResolution resolution(prepared.scan, prepared.time_axis.bin_width_m);
    const WallFrame& wall = prepared.wall;
    core::DepthMap& depth = surface.depth;
    const double width_m = std::max({wall.max_m[0] - wall.min_m[0],
                                     wall.max_m[1] - wall.min_m[1],
                                     depth.x_m.back() - depth.x_m.front(),
                                     depth.y_m.back() - depth.y_m.front()});
    std::vector<std::uint8_t> told(depth.depth_m.size(), 1);
    core::parallel_for(depth.x_m.size(), [&](std::size_t ix) {
        for (std::size_t iy = 0; iy < depth.y_m.size(); ++iy) {
            const std::size_t i = depth.index(ix, iy);
            const bool is_foreground = depth.is_foreground(i);
            const core::Vec3 place =
                is_foreground
                    ? depth.point_world(ix, iy)
                    : depth.world_from_wall * core::Vec3(depth.x_m[ix], depth.y_m[iy], middle_m);
            if (resolution.at(place) <= width_m) continue;
            told[i] = 0;
            if (!is_foreground) continue;
            depth.depth_m[i] = std::numeric_limits<double>::quiet_NaN();
            depth.normals[i].setZero();
            surface.probability[i] = 0.0;
            if (!surface.depth_sigma_m.empty()) surface.depth_sigma_m[i] = depth.depth_m[i];
        }
    });
    return told;
}

/// A method that knows normals knows them better than a plane through neighbouring columns does.
void take_normals(const Volume& volume, core::DepthMap& depth) {
    for (std::size_t i = 0; i < volume.normals.size(); ++i) {
        if (!depth.is_foreground(i)) continue;
        depth.normals[i] = depth.world_from_wall.linear() * volume.normals[i].cast<double>();
    }
}

/// Takes depths, what is known of them and points from the volume and, where the noise is known,
/// that of the scene measured again.
void take_surface(const ReconstructionPlan& plan, const Volume* again, Reconstruction& result) {
    const MethodErrors& known = traits_of(result.settings).errors;
    VolumeErrors errors = known.noisy;
    if (!again) errors.plateau = known.noiseless_plateau;
    // All but confocal grids leave shells before surfaces.
    const PreparedCapture& prepared = plan.prepared;
    const bool is_confocal_grid = prepared.scan.is_confocal() && prepared.scan.sensing.grid;
    if (!is_confocal_grid || !prepared.conversion.empty()) errors.front = 0.0;
    Surface surface = find_surface(result.volume, again, errors, result.settings.mask_threshold);
    const std::vector<double>& z_m = result.volume.axes.z_m;
    result.observed = leave_out_untold(prepared, z_m[z_m.size() / 2], surface);
    result.depth = std::move(surface.depth);
    result.surface_probability = std::move(surface.probability);
    result.depth_sigma_m = std::move(surface.depth_sigma_m);
    take_normals(result.volume, result.depth);
    result.points = surface_points(result.depth);
}

/// Adds what the uncertainty of the set-up does to the surface. Methods that iterate give way to a
/// direct one: what moves with the set-up is geometry, which they share.
void add_setup(const core::Capture& capture,
               const ReconstructionPlan& plan,
               std::size_t num_slabs,
               const core::Progress& progress,
               Reconstruction& result) {
    ReconstructSettings settings = result.settings;
    if (!traits_of(settings).least_work) {
        settings.method = direct_method(plan.prepared, settings.volume);
        settings.prior = Prior::None;
        if (settings.falloff == Falloff::Facing) settings.falloff = Falloff::Diffuse;
    }
    result.setup =
        propagate_setup(capture, result.depth, settings.setup, [&](const core::Capture& moved) {
            Reconstruction other;
            other.settings = settings;
            const ReconstructionPlan own = choose(moved, other);
            const std::optional<core::Transient> histograms =
                prepare(own, own.prepared.transient());
            const MethodInput input = input_of(
                own, histograms ? *histograms : own.prepared.transient(), other.settings, progress);
            enter_falloff(input, own.falloff_trial, other);
            return traits_of(other.settings).run(input, other.settings, num_slabs);
        });
    std::vector<double>& sigma_m = result.depth_sigma_m;
    if (!result.setup || sigma_m.empty()) return;
    std::vector<double> noise_m;
    for (std::size_t i = 0; i < sigma_m.size(); ++i) {
        if (!result.depth.is_foreground(i)) continue;
        noise_m.push_back(sigma_m[i]);
        const double setup_m = result.setup->sigma_m[i];
        sigma_m[i] = std::hypot(sigma_m[i], std::isfinite(setup_m) ? setup_m : 0.0);
    }
    result.setup->noise_sigma_m = core::median(std::move(noise_m));
}

}  // namespace

Reconstruction reconstruct(const core::Capture& capture,
                           const ReconstructSettings& settings,
                           const core::Progress& progress) {
    const core::Stopwatch watch;
    validate(settings);
    core::validate(capture, "capture");
    capture.scan.wall("capture");  // or throws
    Reconstruction result;
    result.settings = settings;
    const CaptureFaults faults = find_faults(capture);
    const core::Capture mended = faults.empty() ? core::Capture{} : leave_out(faults, capture);
    const core::Capture& used = faults.empty() ? capture : mended;
    const ReconstructionPlan plan = choose(used, result);
    std::vector<std::string> doubts = warnings_of(used, plan, result.settings);
    result.warnings.insert(result.warnings.begin(), doubts.begin(), doubts.end());
    if (auto text = describe(faults)) {
        result.warnings.insert(result.warnings.begin(), std::move(*text));
    }
    const std::size_t num_slabs = claim_memory(used, plan, progress, result);

    const core::Progress first_run = progress.part(0.0, plan.knows_noise(used) ? 0.5 : 1.0);
    const std::optional<core::Transient> own = prepare(plan, plan.prepared.transient());
    const MethodInput input =
        input_of(plan, own ? *own : plan.prepared.transient(), result.settings, first_run);
    enter_falloff(input, plan.falloff_trial, result);
    if (progress.announce) {
        for (const std::string& found : result.findings) progress.announce("found: " + found);
    }
    result.volume = traits_of(result.settings).run(input, result.settings, num_slabs);

    core::Progress second_run = progress.part(0.5, 1.0);
    second_run.announce = {};
    {
        const std::optional<Volume> again =
            measured_again(used, plan, result.settings, num_slabs, second_run);
        take_surface(plan, again ? &*again : nullptr, result);
    }
    add_setup(used, plan, num_slabs, second_run, result);
    result.seconds = watch.seconds();
    result.peak_bytes = core::peak_rss_bytes();
    return result;
}

}  // namespace nlos
