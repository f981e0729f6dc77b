// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"

#include "nlos/methods/methods.h"
#include "nlos/methods/virtual_wave.h"
#include "nlos/preparation/capture_check.h"
#include "nlos/preparation/direct_response.h"
#include "nlos/preparation/histogram_preparation.h"
#include "nlos/preparation/memory_limit.h"
#include "nlos/preparation/prepared_capture.h"
#include "nlos/preparation/second_capture.h"
#include "nlos/reconstruct_choices.h"
#include "nlos/reconstruction/surface.h"
#include "nlos/solver/confocal_solver.h"
#include "nlos/solver/solver.h"
#include "renderer/core/capture/recorded_detector.h"
#include "renderer/core/process.h"
#include "renderer/core/stopwatch.h"

#include <fmt/format.h>

#include <utility>

namespace nlos {
namespace {

constexpr double kSteepest = 2.0;      // slope of surfaces that the solver's masks hold
constexpr double kFront = 0.4;         // confocal grids: columns are dark between two surfaces
constexpr std::size_t kMaxSlabs = 64;  // each repeats a part of the work

/// A method that knows normals knows them better than a plane through neighbouring columns does.
void take_normals(const Volume& volume, core::DepthMap& depth) {
    for (std::size_t i = 0; i < volume.normals.size(); ++i) {
        if (!depth.is_foreground(i)) continue;
        depth.normals[i] = depth.world_from_wall.linear() * volume.normals[i].cast<double>();
    }
}

/// Noise makes dim columns of its own: where there may be any, all columns are held against the
/// brightest surfaces alone. Backprojection leaves no edges, and the solver sharp ones. Fits random
/// surfaces, see reconstruction/README.md.
PlateauShares plateau_shares(const ReconstructSettings& settings, bool has_noise) {
    if (settings.method == Method::Bp) return {0.0, 0.75, 7.0};
    if (settings.method == Method::Solver) return {0.0, has_noise ? 0.4 : 0.35};
    if (settings.method == Method::Fk) {
        return has_noise ? PlateauShares{0.0, 0.5, 8.0} : PlateauShares{0.7, 0.3, 8.0};
    }
    if (!has_noise) return {};
    if (uses_wave(settings) || settings.method == Method::Fbp) return {0.0, 0.5};
    return {0.0, 0.52, 5.0};
}

/// Waves give magnitudes. The shares of the deviations of depth (model, noise,
/// doubt, neighbours) are those of random surfaces, see reconstruction/README.md.
///
/// scan   of the capture; all but confocal grids leave shells before surfaces
VolumeErrors volume_errors(const ReconstructSettings& settings,
                           const core::WallScan& scan,
                           bool has_noise) {
    const PlateauShares shares = plateau_shares(settings, has_noise);
    const bool is_confocal_grid = scan.is_confocal() && scan.sensing.grid;
    const double front = is_confocal_grid ? kFront : 0.0;
    if (uses_wave(settings)) return {VolumeScale::Magnitude, 0.115, 0.3, 7.0, 0.0, shares};
    switch (settings.method) {
        case Method::Solver:
            return {VolumeScale::Amplitude, 0.067, 0.345, 23.0, 0.0, shares, kSteepest, front};
        case Method::Fk:
            return {VolumeScale::Amplitude, 0.044, 0.345, 8.0, 0.27, shares, 0.0, front};
        case Method::Bp:
            return {VolumeScale::Amplitude, 0.042, 0.45, 5.0, 0.0, shares};
        case Method::Fbp:
            return {VolumeScale::Amplitude, 0.055, 0.39, 5.5, 0.0, shares};
        case Method::Dlct:
            return {VolumeScale::Amplitude, 0.047, 0.48, 5.5, 0.0, shares};
        default:
            return {VolumeScale::Amplitude, 0.025, 0.34, 16.0, 0.0, shares};
    }
}

/// Takes depths, what is known of them and points from the volume and, where the noise is known,
/// that of the scene measured again.
///
/// scan   of the capture
void take_surface(const core::WallScan& scan, const Volume* again, Reconstruction& result) {
    Surface surface = find_surface(result.volume,
                                   again,
                                   volume_errors(result.settings, scan, again != nullptr),
                                   result.settings.mask_threshold);
    result.depth = std::move(surface.depth);
    result.surface_probability = std::move(surface.probability);
    result.depth_sigma_m = std::move(surface.depth_sigma_m);
    take_normals(result.volume, result.depth);
    result.points = surface_points(result.depth);
}

/// What a method computes, and the memory that takes.
struct MethodFunctions {
    RunMethod* run;
    MethodBytes* bytes;
};

MethodFunctions functions_of(const ReconstructSettings& settings) {
    switch (settings.method) {
        case Method::Solver:
            return {solve, solve_bytes};
        case Method::Lct:
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

/// One reconstruction: what was chosen, and the steps that use it.
class Job {
 public:
    Job(const core::Capture& capture,
        const ReconstructSettings& settings,
        const core::Progress& progress)
        : capture_(capture),
          progress_(progress),
          is_auto_(settings.method == Method::Auto && settings.prior == Prior::None),
          has_noise_(knows_its_noise(capture)),
          first_run_(progress.part(0.0, has_noise_ ? 0.5 : 1.0)),
          second_run_(progress.part(0.5, 1.0)) {
        second_run_.announce = {};
        result_.settings = settings;
        const bool takes_lct = settings.method == Method::Auto || settings.method == Method::Lct;
        if (settings.prior == Prior::Tv && takes_lct) result_.settings.method = Method::Solver;
    }

    Reconstruction run() {
        choose();
        const std::size_t num_slabs = claim_memory();
        core::Transient histograms;
        if (!is_ready()) histograms = prepare(prepared_.transient());
        const MethodInput input =
            input_with(is_ready() ? prepared_.transient() : histograms, first_run_);
        choose_falloff_of(input);
        if (progress_.announce) {
            for (const std::string& found : result_.findings) progress_.announce("found: " + found);
        }
        const ReconstructSettings& settings = result_.settings;
        result_.volume = functions_of(settings).run(input, settings, num_slabs);
        std::optional<Volume> again;
        if (const auto second = measure_again(capture_)) {
            PreparedCapture prepared = crop_capture(*second, settings.crop);
            if (!prepared_.conversion.empty()) convert_to_confocal(prepared);
            histograms = prepare(prepared.transient());
            again = functions_of(settings).run(
                input_with(histograms, second_run_), settings, num_slabs);
        }
        take_surface(capture_.scan.wall(), again ? &*again : nullptr, result_);
        return std::move(result_);
    }

 private:
    /// Fills in whatever the settings leave open.
    void choose() {
        ReconstructSettings& settings = result_.settings;
        settings.response = core::resolve_response(settings.response, capture_, "response");
        if (is_auto_) leave_out_direct_return();
        prepared_ = crop_capture(capture_, settings.crop);
        const MethodChoice choice = choose_and_enter_method(capture_, settings, prepared_);
        core::require(settings.falloff != Falloff::Facing || choice.method == Method::Solver,
                      "falloff",
                      fmt::format("facing with method {}", core::enum_name(choice.method)),
                      "diffuse or retro; method=solver knows facing");
        result_.method = core::enum_name(choice.method);
        result_.reason = choice.reason;
        result_.warnings = capture_warnings(capture_);
        for (std::string& text : core::detector_warnings(capture_, settings.response)) {
            result_.warnings.push_back(std::move(text));
        }
        plan_ = choose_preparation(prepared_, settings);
        axis_ = prepared_.time_axis;
        axis_.bin_width_m *= plan_.merge_bins;
        axis_.num_bins = plan_.num_bins;
        if (is_auto_) {
            for (std::string& found : survey_capture(prepared_, plan_, settings)) {
                result_.findings.push_back(std::move(found));
            }
        }
        if (choice.method == Method::Solver) {
            measurement_ = take_measurement(prepared_, settings, axis_, plan_);
        }
        if (uses_wave(settings)) choose_wavelength(settings.phasor);
        choose_axes(prepared_.scan, axis_, prepared_.wall, settings, axes_);
        observed_ = prepared_observed(plan_);
        core::simplify(observed_, axis_.num_bins);
        if (auto warning = unobserved_warning(settings, observed_, axis_.num_bins)) {
            result_.warnings.push_back(std::move(*warning));
        }
        if (auto warning = few_pairs_warning(prepared_.scan)) {
            result_.warnings.push_back(std::move(*warning));
        }
    }

    /// Fills the wavelength in; bins can tell no shorter ones from longer ones.
    void choose_wavelength(PhasorSettings& phasor) const {
        if (!phasor.wavelength_m) {
            phasor.wavelength_m = default_wavelength_m(prepared_.scan, prepared_.wall, axis_);
        }
        if (*phasor.wavelength_m < axis_.bin_width_m) {
            throw core::Error("phasor.wavelength_m",
                              fmt::format("found {:.3g} m", *phasor.wavelength_m),
                              fmt::format("must be at least a bin, {:.3g} m", axis_.bin_width_m));
        }
    }

    /// Crops the wall's direct return off, whose shape is the response unless one is known.
    void leave_out_direct_return() {
        ReconstructSettings& settings = result_.settings;
        if (settings.crop.opl_range_m) return;
        const std::optional<DirectResponse> direct = measure_direct_return(capture_);
        const double end_m = capture_.time_axis.opl_end_m();
        if (!direct || direct->end_opl_m >= end_m) return;
        settings.crop.opl_range_m = {direct->end_opl_m, end_m};
        if (!core::is_stated(settings.response) && !core::recorded_response(capture_)) {
            settings.response = direct->response;
        }
        result_.findings.push_back(describe(*direct));
    }

    /// Whether the capture's own histograms are what the method gets.
    bool is_ready() const {
        return plan_.num_bins == prepared_.time_axis.num_bins && plan_.ambient_per_bin.empty() &&
               !plan_.deconvolution && !makes_up_for_falloff(prepared_.scan, result_.settings);
    }

    /// Says what will run and what it needs. Returns the number of slabs.
    std::size_t claim_memory() {
        const ReconstructSettings& settings = result_.settings;
        double other_bytes =
            is_ready() && !has_noise_
                ? 0.0
                : 4.0 * static_cast<double>(prepared_.scan.num_pairs()) * axis_.num_bins;
        if (has_noise_) {  // the scene measured again, and its volume
            other_bytes += 4.0 * static_cast<double>(capture_.transient.values().size()) +
                           prepared_.own_bytes() + 4.0 * static_cast<double>(axes_.num_voxels());
        }
        const MethodInput input = input_with(prepared_.transient(), first_run_);
        const std::size_t num_slabs = choose_slabs(input, settings, other_bytes);
        const double bytes = other_bytes + functions_of(settings).bytes(input, settings, num_slabs);
        require_memory(bytes, settings.memory_gb);
        result_.stated_bytes = bytes + prepared_.own_bytes();
        announce(result_, num_slabs, progress_);
        check_stop(progress_);
        return num_slabs;
    }

    core::Transient prepare(const core::Transient& transient) const {
        core::Transient histograms = prepare_histograms(transient, plan_);
        if (makes_up_for_falloff(prepared_.scan, result_.settings)) {
            multiply_by_range(
                prepared_.scan, axis_, falloff_power(result_.settings.falloff), histograms);
        }
        return histograms;
    }

    MethodInput input_with(const core::Transient& transient, const core::Progress& part) const {
        return {prepared_.scan,
                axis_,
                transient,
                prepared_.wall,
                axes_,
                *result_.settings.volume.z_range_m,
                part,
                observed_ ? &*observed_ : nullptr,
                prepared_.unobserved_before_m,
                measurement_};
    }

    /// Enters how light falls off: as the data say where they do, else diffuse.
    void choose_falloff_of(const MethodInput& input) {
        ReconstructSettings& settings = result_.settings;
        if (settings.falloff != Falloff::Auto) return;
        settings.falloff = Falloff::Diffuse;
        if (settings.method != Method::Solver || !is_confocal_grid(input)) return;
        if (!is_auto_ && !needs_falloff_choice(input)) return;
        FalloffChoice choice = choose_falloff(input, settings);
        settings.falloff = choice.falloff;
        result_.findings.push_back(std::move(choice.reason));
    }

    const core::Capture& capture_;
    const core::Progress& progress_;
    bool is_auto_, has_noise_;
    core::Progress first_run_, second_run_;
    Reconstruction result_;
    PreparedCapture prepared_;
    PreparationPlan plan_;
    core::TimeAxis axis_;  ///< of prepared histograms
    core::ObservedBins observed_;
    Measurement measurement_;
    VolumeAxes axes_;
};

}  // namespace

Reconstruction reconstruct(const core::Capture& capture,
                           const ReconstructSettings& settings,
                           const core::Progress& progress) {
    const core::Stopwatch watch;
    validate(settings);
    core::validate(capture, "capture");
    capture.scan.wall("capture");  // or throws
    Reconstruction result = Job(capture, settings, progress).run();
    result.seconds = watch.seconds();
    result.peak_bytes = core::peak_rss_bytes();
    return result;
}

}  // namespace nlos
