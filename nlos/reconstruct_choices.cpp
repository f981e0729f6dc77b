// SPDX-License-Identifier: MIT
#include "nlos/reconstruct_choices.h"

#include "nlos/methods/virtual_wave.h"
#include "nlos/preparation/blind_response.h"
#include "nlos/preparation/checks/capture_check.h"
#include "nlos/preparation/direct_response.h"
#include "nlos/preparation/place_resolution.h"
#include "nlos/preparation/wiener_snr.h"
#include "nlos/setup_uncertainty.h"
#include "nlos/volume_choices.h"
#include "renderer/core/capture/recorded_detector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace nlos {
namespace {

constexpr int kTaperBins = 6;           // after merging
constexpr double kBinOfResponse = 0.4;  // standard deviations: widens it by less than 1 %

/// Wall points' distance, where they form a grid.
double pitch_m(const PreparedCapture& prepared) {
    return std::min(prepared.wall.grid->pitch_m[0], prepared.wall.grid->pitch_m[1]);
}

/// As many bins as keep the range they cover within a quarter of the wall points' distance: finer
/// depth than that no aperture of this sampling resolves, and noise and work shrink with the bins.
/// A gate keeps some bins too. A method that explains the response takes wider ones where that
/// smears more.
int default_merge_bins(const PreparedCapture& prepared, const ReconstructSettings& settings) {
    const core::TimeAxis& axis = prepared.time_axis;
    if (!prepared.wall.grid) return 1;
    double limit_m = 0.25 * pitch_m(prepared);
    if (traits_of(settings).explains_response && core::is_given(settings.response)) {
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

/// The given response on bins of an axis; no weights: none is given.
core::ResponseFilter response_filter(const ReconstructSettings& settings,
                                     const core::TimeAxis& axis) {
    if (!core::is_given(settings.response)) return {};
    return core::sample_response(core::make_response(settings.response, "response"),
                                 axis.bin_width_m);
}

/// Half the path lengths that the axis covers once device segments are taken off.
std::array<double, 2> default_z_range(const core::WallScan& scan, const core::TimeAxis& axis) {
    const auto [shortest_segment, longest_segment] = core::device_segment_range_m(scan);
    const double begin = std::max(0.0, 0.5 * (axis.opl_start_m - longest_segment));
    const double end = 0.5 * (axis.opl_end_m() - shortest_segment);
    if (!(end > begin)) {
        throw core::Error("capture",
                          fmt::format("the time axis ends at a range of {:.4g} m", end),
                          "it must reach beyond the wall");
    }
    return {begin, end};
}

/// Crops the wall's direct return off, whose shape is the response unless one is known.
void leave_out_direct_return(const core::Capture& capture, Reconstruction& result) {
    ReconstructSettings& settings = result.settings;
    if (settings.crop.opl_range_m) return;
    const std::optional<DirectResponse> direct = measure_direct_return(capture);
    const double end_m = capture.time_axis.opl_end_m();
    if (!direct || direct->end_opl_m >= end_m) return;
    settings.crop.opl_range_m = {direct->end_opl_m, end_m};
    const bool is_open = !core::is_given(settings.response) && !settings.response.is_none;
    if (is_open && !core::recorded_response(capture)) {
        settings.response = direct->response;
    }
    result.findings.push_back(describe(*direct));
}

/// Takes background light off, and what is behind the signal unless depths there are asked for.
/// Counts have a background unless told otherwise, radiance where it stands on a constant level.
void leave_out_background(const PreparedCapture& prepared,
                          ReconstructSettings& settings,
                          PreparationPlan& plan) {
    if (settings.ambient == Ambient::Keep) return;
    auto signal = find_signal(prepared.transient(), prepared.observed, prepared.unit);
    if (settings.ambient == Ambient::Auto) {
        const bool is_counts = prepared.unit == core::TransientUnit::Counts;
        const bool has_any =
            is_counts || settings.noise_floor || (signal && signal->has_background);
        settings.ambient = has_any ? Ambient::Subtract : Ambient::Keep;
        if (!has_any) return;
    }
    if (signal) {
        const bool tells_noise = signal->has_background && signal->photon > 0.0;
        if (tells_noise && prepared.unit != core::TransientUnit::Counts &&
            prepared.conversion.empty()) {
            plan.photon = signal->photon;
        }
        plan.ambient_per_bin = std::move(signal->ambient_per_bin);
        plan.taper.begin_bin = signal->begin_bin;
        const int taper_bins = kTaperBins * plan.merge_bins;
        if (signal->has_background) plan.taper.opening_bins = taper_bins;
        if (signal->reaches_the_end) plan.taper.end_bins = taper_bins;
        const int end = (signal->end_bin + plan.merge_bins - 1) / plan.merge_bins;
        if (!settings.volume.z_range_m) {
            plan.num_bins = std::clamp(end, std::min(kMinBins, plan.num_bins), plan.num_bins);
        }
    }
    if (settings.noise_floor) {
        plan.ambient_per_bin.assign(prepared.scan.num_pairs(), *settings.noise_floor);
    }
}

/// Fills in merge_bins, ambient and z_range_m, and says what becomes of the histograms.
PreparationPlan choose_preparation(const PreparedCapture& prepared, ReconstructSettings& settings) {
    const core::TimeAxis& axis = prepared.time_axis;
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
    leave_out_background(prepared, settings, plan);
    if (!settings.volume.z_range_m) {
        settings.volume.z_range_m = default_z_range(prepared.scan, plan.prepared_axis(axis));
    }
    const MethodTraits& method = traits_of(settings);
    if (!method.explains_response && core::is_given(settings.response)) {
        plan.deconvolution =
            std::make_shared<const ResponseDeconvolution>(response_filter(settings, axis),
                                                          static_cast<std::size_t>(axis.num_bins),
                                                          settings.response_floor);
    }
    return plan;
}

/// Whether a response may be looked for that nobody stated.
bool may_tell_response(const PreparedCapture& prepared, const ReconstructSettings& settings) {
    const bool is_stated = core::is_given(settings.response) || settings.response.is_none;
    return !is_stated && prepared.time_axis.num_bins >= kMinBins && prepared.wall.grid;
}

/// The method, with what it takes from the capture's provenance. What explains only responses that
/// are stated gives way to a direct method where another one shows, which that has taken off.
void choose_and_enter_method(const core::Capture& capture,
                             PreparedCapture& prepared,
                             Reconstruction& result) {
    ReconstructSettings& settings = result.settings;
    if (!settings.solver.spot_m) {
        settings.solver.spot_m = core::recorded_spot_m(capture).value_or(0.0);
    }
    const bool is_auto = settings.method == Method::Auto;
    MethodChoice choice = choose_method(settings, prepared);
    settings.method = choice.method;
    if (is_auto && traits_of(settings).explains_response &&
        settings.blind_deconvolution == BlindDeconvolution::Auto &&
        may_tell_response(prepared, settings)) {
        ReconstructSettings direct = settings;
        direct.method = kPreferredMethods.front()->method;
        const PreparationPlan plan = choose_preparation(prepared, direct);
        const MeanSpectrum spectrum =
            mean_spectrum(prepared.transient(), plan, prepared.time_axis.bin_width_m);
        if (shows_response(spectrum, pitch_m(prepared))) {
            settings.method = direct.method;
            choice.reason += ", a response that nobody stated";
        }
    }
    result.method = core::enum_name(settings.method);
    result.reason = choice.reason;
}

/// Tells a response from the histograms and takes it off, where that is asked for or, as none is
/// stated, needed.
///
/// returns   what was found, for people; nothing where nothing is taken off
std::optional<std::string> take_off_blind_response(const PreparedCapture& prepared,
                                                   ReconstructSettings& settings,
                                                   PreparationPlan& plan) {
    BlindDeconvolution& choice = settings.blind_deconvolution;
    const bool is_open = choice == BlindDeconvolution::Auto;
    if (!is_open && choice == BlindDeconvolution::Off) return std::nullopt;
    const bool explains = traits_of(settings).explains_response;
    if (!is_open) {
        core::require(!core::is_given(settings.response),
                      "blind_deconvolution",
                      "on with a response",
                      "on where no response is known; response=none forgets that of the capture");
        core::require(!explains,
                      "blind_deconvolution",
                      fmt::format("on with method {}", core::enum_name(settings.method)),
                      "auto or off for methods that explain a response; response states one");
        core::require(prepared.time_axis.num_bins >= kMinBins,
                      "blind_deconvolution",
                      fmt::format("on with {} bins", prepared.time_axis.num_bins),
                      fmt::format("on for {} bins or more", kMinBins));
    }
    if (is_open) choice = BlindDeconvolution::Off;
    if (is_open && (explains || !may_tell_response(prepared, settings))) return std::nullopt;
    const core::TimeAxis& axis = prepared.time_axis;
    const MeanSpectrum spectrum = mean_spectrum(prepared.transient(), plan, axis.bin_width_m);
    if (is_open && !shows_response(spectrum, pitch_m(prepared))) return std::nullopt;
    choice = BlindDeconvolution::On;
    const BlindResponse response =
        find_blind_response(spectrum, static_cast<std::size_t>(axis.num_bins));
    plan.deconvolution = response.deconvolution;
    return describe(response);
}

/// The signal to noise ratio of methods that have a Wiener filter, unless set. That of a blind
/// response has left out what is noise.
void choose_snr(const PreparedCapture& prepared,
                const PreparationPlan& plan,
                ReconstructSettings& settings) {
    if (!traits_of(settings).has_wiener_filter || settings.snr) return;
    const bool tells_noise = prepared.unit == core::TransientUnit::Counts &&
                             settings.blind_deconvolution != BlindDeconvolution::On;
    settings.snr =
        tells_noise
            ? wiener_snr(
                  prepared.scan, prepared.time_axis, prepared.transient(), plan, settings.falloff)
            : kNoiselessSnr;
}

/// What the method explains of the histograms instead of having it taken off.
///
/// axis   of the prepared histograms
/// plan   its ambient light moves here
Measurement take_measurement(const PreparedCapture& prepared,
                             const ReconstructSettings& settings,
                             const core::TimeAxis& axis,
                             PreparationPlan& plan) {
    const MethodTraits& method = traits_of(settings);
    Measurement measurement;
    const auto is_negative = [](float value) { return value < 0.0F; };
    measurement.is_counts = prepared.unit == core::TransientUnit::Counts &&
                            std::ranges::none_of(prepared.transient().values(), is_negative);
    if (method.explains_background) {
        measurement.background_per_bin = std::exchange(plan.ambient_per_bin, {});
        for (double& value : measurement.background_per_bin) value *= plan.merge_bins;
    }
    if (method.explains_response) measurement.response = response_filter(settings, axis);
    return measurement;
}

/// Fills the wavelength in; bins can tell no shorter ones from longer ones.
void choose_wavelength(const PreparedCapture& prepared,
                       const core::TimeAxis& axis,
                       PhasorSettings& phasor) {
    if (!phasor.wavelength_m) {
        phasor.wavelength_m = default_wavelength_m(prepared.scan, prepared.wall, axis);
    }
    if (*phasor.wavelength_m < axis.bin_width_m) {
        throw core::Error("phasor.wavelength_m",
                          fmt::format("found {:.3g} m", *phasor.wavelength_m),
                          fmt::format("must be at least a bin, {:.3g} m", axis.bin_width_m));
    }
}

void append(std::vector<std::string> more, std::vector<std::string>& texts) {
    std::ranges::move(more, std::back_inserter(texts));
}

/// Path length from which on prepared histograms are 0: the end of the last bin that holds
/// anything, unless what is taken off leaves something in every bin.
double dark_from_m(const PreparedCapture& prepared, const PreparationPlan& plan) {
    const core::TimeAxis axis = plan.prepared_axis(prepared.time_axis);
    if (plan.deconvolution || !plan.ambient_per_bin.empty()) return axis.opl_end_m();
    int end = 0;
    for (std::size_t pair = 0; pair < prepared.scan.num_pairs(); ++pair) {
        const auto histogram = prepared.transient().histogram(pair);
        int last = prepared.time_axis.num_bins;
        while (last > end && histogram[static_cast<std::size_t>(last - 1)] == 0.0F) --last;
        end = std::max(end, last);
    }
    return axis.bin_begin_m((end + plan.merge_bins - 1) / plan.merge_bins);
}

/// How far apart the captured light tells positions: by its bins or, where it is wider, by the
/// response [m].
std::optional<double> data_resolution_m(const PreparedCapture& prepared,
                                        const core::ResponseSettings& response) {
    if (!prepared.light || !std::isfinite(prepared.light->resolution_m)) return std::nullopt;
    const double response_m = response.jitter_fwhm_ps * 1e-12 * core::kSpeedOfLight;
    return prepared.light->resolution_m *
           std::max(1.0, response_m / prepared.time_axis.bin_width_m);
}

}  // namespace

ReconstructionPlan choose(const core::Capture& capture, Reconstruction& result) {
    ReconstructSettings& settings = result.settings;
    const bool has_range = settings.volume.z_range_m.has_value();
    if (settings.prior == Prior::Tv &&
        (settings.method == Method::Auto || traits_of(settings).gives_way_to_prior)) {
        settings.method = kStatisticalMethod.method;
    }
    const bool is_auto = settings.method == Method::Auto;
    enter_uncertainties(capture, settings.setup);
    settings.response = core::resolve_response(settings.response, capture, "response");
    if (is_auto) leave_out_direct_return(capture, result);

    ReconstructionPlan plan;
    plan.prepared = crop_capture(capture, settings.crop);
    plan.prepared.light = resolve_light(plan.prepared);
    result.resolution_m = data_resolution_m(plan.prepared, settings.response);
    choose_and_enter_method(capture, plan.prepared, result);
    plan.preparation = choose_preparation(plan.prepared, settings);
    const auto blind = take_off_blind_response(plan.prepared, settings, plan.preparation);
    choose_snr(plan.prepared, plan.preparation, settings);
    plan.time_axis = plan.preparation.prepared_axis(plan.prepared.time_axis);
    plan.observed = prepared_observed(plan.preparation);
    core::simplify(plan.observed, plan.time_axis.num_bins);
    if (is_auto) {
        plan.falloff_trial = FalloffTrial::Always;
        append(survey_capture(plan.prepared, plan.preparation, settings), result.findings);
    }
    const auto beside = volume_warning(plan.prepared, plan.preparation, *settings.volume.z_range_m);
    plan.measurement = take_measurement(plan.prepared, settings, plan.time_axis, plan.preparation);
    if (traits_of(settings).propagates_wave) {
        choose_wavelength(plan.prepared, plan.time_axis, settings.phasor);
        // A confocal scan lights every voxel from all over the wall; there the factor would only
        // let far wall points outvote near ones.
        if (!plan.prepared.scan.is_confocal()) {
            plan.range_power = falloff_power(settings.falloff);
        }
    }
    plan.axes = choose_axes(plan.prepared, plan.time_axis, settings);
    plan.dark_from_m =
        has_range ? plan.time_axis.opl_end_m() : dark_from_m(plan.prepared, plan.preparation);
    if (beside) result.warnings.push_back(*beside);
    if (blind) result.warnings.push_back(*blind);
    return plan;
}

std::vector<std::string> warnings_of(const core::Capture& capture,
                                     const ReconstructionPlan& plan,
                                     const ReconstructSettings& settings) {
    std::vector<std::string> warnings = capture_warnings(capture);
    if (auto text = core::detector_warning(capture)) warnings.push_back(std::move(*text));
    if (auto text = unobserved_warning(settings, plan.observed, plan.time_axis.num_bins)) {
        warnings.push_back(std::move(*text));
    }
    if (auto text = directions_warning(plan.prepared)) warnings.push_back(std::move(*text));
    return warnings;
}

}  // namespace nlos
