// SPDX-License-Identifier: MIT
#include "nlos/detector/detector.h"

#include "nlos/detector/count_sampling.h"
#include "nlos/detector/dead_time.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace nlos {
namespace {

constexpr double kPlanck_J_s = 6.62607015e-34;
constexpr double kMaxPulses = 1e15;
constexpr double kMaxCounts = 1e15;  // expected in all pairs; sums of counts stay exact in double
constexpr double kLongestBlindPeriods = 16.0;

using core::require;

bool is_blind_at_times(const DetectorSettings& s) {
    return s.pile_up || s.dead_time_ns > 0.0;
}

double sum_of(const core::Transient& transient) {
    double sum = 0.0;
    for (const float value : transient.values()) {
        if (!(value >= 0.0F)) {
            throw core::Error("capture", fmt::format("found {}", value), "must not be negative");
        }
        sum += static_cast<double>(value);
    }
    return sum;
}

// Of a frame, on average.
double sum_of(const core::Capture& capture) {
    if (!capture.sequence) return sum_of(capture.transient);
    double sum = 0.0;
    for (const core::Transient& frame : capture.sequence->frames) sum += sum_of(frame);
    return sum / static_cast<double>(capture.sequence->frames.size());
}

std::size_t num_observed_pairs(const core::Capture& capture) {
    std::size_t count = 0;
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        if (capture.observed_range(pair).size() > 0) ++count;
    }
    return count;
}

/// Expected counts for one unit of the capture.
double counts_per_value(const core::Capture& capture, const DetectorSettings& s) {
    const double sum = sum_of(capture);
    if (s.photons || s.photons_per_point) {
        if (!(sum > 0.0)) {
            throw core::Error(
                "capture", "found no light", "must hold light to scale to a number of photons");
        }
        const auto pairs = static_cast<double>(num_observed_pairs(capture));
        return s.photons.value_or(s.photons_per_point.value_or(0.0) * pairs) / sum;
    }
    if (capture.unit != core::TransientUnit::Radiance) {
        throw core::Error("exposure_s",
                          "found alone for a capture in counts",
                          "must stand beside photons; only radiance has a rate of photons");
    }
    const RadiometrySettings& r = s.radiometry;
    const double photon_J = kPlanck_J_s * core::kSpeedOfLight / (1e-9 * r.wavelength_nm);
    return *s.exposure_s * r.laser_w * r.etendue_m2_sr * r.efficiency / photon_J;
}

/// Everything about the detector that is the same for all pairs.
struct Detector {
    double counts_per_value = 0.0;
    double background = 0.0;  ///< expected counts per bin
    core::ResponseFilter filter;
    bool is_blind_at_times = false;
    PulseTrain train;
    bool expected = false;
    std::uint64_t seed = 0;
};

PulseTrain make_train(const core::TimeAxis& axis, const DetectorSettings& s, double background) {
    const double bin_s = axis.bin_width_m / core::kSpeedOfLight;
    const double period_bins = 1.0 / (s.repetition_hz * bin_s);
    const double gap_bins = std::round(period_bins) - axis.num_bins;
    require(gap_bins >= 0.0,
            "repetition_hz",
            s.repetition_hz,
            fmt::format("at most {:.6g}: the axis has to fit between two pulses",
                        1.0 / (axis.num_bins * bin_s)));
    PulseTrain train;
    train.pulses =
        std::max<std::int64_t>(1, std::llround(s.repetition_hz * s.exposure_s.value_or(1.0)));
    train.first_photon_only = s.pile_up;
    // A detection lies half a bin, on average, before its bin's end.
    train.blind_bins =
        static_cast<std::size_t>(std::max(0.0, std::round(1e-9 * s.dead_time_ns / bin_s - 0.5)));
    // Without dead time nothing of the gap is felt on the axis.
    if (train.blind_bins > 0) train.gap_bins = static_cast<std::size_t>(gap_bins);
    if (!s.pile_up) train.gap_rate = background / static_cast<double>(train.pulses);
    return train;
}

Detector make_detector(const core::Capture& capture, const DetectorSettings& s) {
    const core::TimeAxis& axis = capture.time_axis;
    Detector detector;
    detector.counts_per_value = counts_per_value(capture, s);
    const double signal = detector.counts_per_value * sum_of(capture);
    require(signal <= kMaxCounts, "photons", signal, "at most 1e15 counts");
    const double open_s = axis.bin_width_m / core::kSpeedOfLight * s.repetition_hz *
                          s.exposure_s.value_or(1.0);  // time per bin over all pulses
    detector.background = s.ambient + s.dark_counts_hz * open_s;
    const double background =
        detector.background *
        static_cast<double>(core::observed_count(
            capture.observed, capture.scan.num_pairs(), capture.time_axis.num_bins));
    require(
        background <= kMaxCounts, "ambient and dark_counts_hz", background, "at most 1e15 counts");
    detector.filter =
        core::sample_response(core::make_response(s.response, "response"), axis.bin_width_m);
    detector.is_blind_at_times = is_blind_at_times(s);
    if (detector.is_blind_at_times) detector.train = make_train(axis, s, detector.background);
    detector.expected = s.expected;
    detector.seed = s.seed;
    return detector;
}

/// Records one pair: radiance or counts in, counts out. A detector that does not look detects
/// nothing, so that nothing blinds it either.
void record(const Detector& detector,
            std::size_t pair,
            std::size_t frame,
            const core::BinRange& observed,
            std::span<const float> input,
            std::span<float> output) {
    const int num_bins = static_cast<int>(input.size());
    std::vector<double> means(input.size());
    core::apply_filter<float, double>(detector.filter, input, means);
    for (int bin = 0; bin < num_bins; ++bin) {
        double& mean = means[static_cast<std::size_t>(bin)];
        mean = observed.holds(bin) ? mean * detector.counts_per_value + detector.background : 0.0;
    }
    core::Rng rng(detector.seed, pair, frame);
    if (detector.is_blind_at_times) {
        for (double& mean : means) mean /= static_cast<double>(detector.train.pulses);
        PulseTrain train = detector.train;
        if (observed.size() < num_bins) train.gap_rate = 0.0;
        const std::vector<double> counts =
            count_with_dead_time(means, train, detector.expected ? nullptr : &rng);
        std::transform(counts.begin(), counts.end(), output.begin(), [](double count) {
            return static_cast<float>(count);
        });
        return;
    }
    for (std::size_t bin = 0; bin < means.size(); ++bin) {
        output[bin] = detector.expected ? static_cast<float>(means[bin])
                                        : static_cast<float>(sample_poisson(rng, means[bin]));
    }
}

}  // namespace

void validate(const DetectorSettings& settings) {
    core::check_ranges(settings, "");
    core::check_ranges(settings.radiometry, "radiometry");
    if (settings.photons && settings.photons_per_point) {
        throw core::Error("photons", "found beside photons_per_point", "must be one of the two");
    }
    if (!settings.photons && !settings.photons_per_point && !settings.exposure_s) {
        throw core::Error("photons",
                          "found neither photons, photons_per_point nor exposure_s",
                          "must be one of them");
    }
    const double pulses = settings.repetition_hz * settings.exposure_s.value_or(1.0);
    require(pulses <= kMaxPulses,
            "exposure_s",
            settings.exposure_s.value_or(1.0),
            fmt::format("at most {:g}: 1e15 pulses", kMaxPulses / settings.repetition_hz));
    const double blind_periods = 1e-9 * settings.dead_time_ns * settings.repetition_hz;
    require(blind_periods <= kLongestBlindPeriods,
            "dead_time_ns",
            settings.dead_time_ns,
            fmt::format("at most {} periods of repetition_hz", kLongestBlindPeriods));
}

std::optional<std::string> coarse_bins_warning(const core::Capture& capture,
                                               const DetectorSettings& settings) {
    if (!core::is_given(settings.response)) return std::nullopt;
    const core::ResponseMoments response =
        core::moments(core::make_response(settings.response, "response"));
    const double width_m = capture.time_axis.bin_width_m;
    const double fwhm_ps = std::sqrt(response.variance_m2) / core::sigma_m_from_fwhm_ps(1.0);
    const double widest_m = core::widest_bin_m(fwhm_ps);
    if (widest_m == 0.0 || width_m <= widest_m) return std::nullopt;
    const double bins = 0.5 * width_m / widest_m;  // per standard deviation of the response
    return fmt::format(
        "a response of {:.3g} ps (FWHM) is narrow beside bins of {:.3g} ps: sharp edges come out "
        "up to {:.2g} % narrower than it; light in bins of {:.2g} ps helps, "
        "time_axis.bin_width_ps={:.2g}",
        fwhm_ps,
        1e12 * width_m / core::kSpeedOfLight,
        100.0 * (1.0 - std::sqrt(std::max(0.0, 1.0 - bins * bins / 12.0))),
        1e12 * widest_m / core::kSpeedOfLight,
        1e12 * widest_m / core::kSpeedOfLight);
}

core::Capture detect(const core::Capture& capture, const DetectorSettings& settings) {
    validate(settings);
    core::validate(capture, "capture");
    const Detector detector = make_detector(capture, settings);

    core::Capture result;
    result.scan = capture.scan;
    result.time_axis = capture.time_axis;
    result.unit = core::TransientUnit::Counts;
    if (capture.unit == core::TransientUnit::Radiance) {
        result.counts_per_radiance = detector.counts_per_value;
    } else if (capture.counts_per_radiance) {
        result.counts_per_radiance = *capture.counts_per_radiance * detector.counts_per_value;
    }
    result.scene_info = capture.scene_info;
    result.scene_info["detector"] = core::write_value(settings);
    if (detector.is_blind_at_times) result.scene_info["detector"]["pulses"] = detector.train.pulses;
    result.notes = capture.notes;

    result.observed = capture.observed;
    const auto record_frame = [&](std::size_t frame, const core::Transient& light) {
        core::Transient counts(capture.scan.num_pairs(), capture.time_axis.num_bins);
        core::parallel_for(capture.scan.num_pairs(), [&](std::size_t pair) {
            record(detector,
                   pair,
                   frame,
                   core::observed_range(
                       capture.observed_in_frame(frame), pair, capture.time_axis.num_bins),
                   light.histogram(pair),
                   counts.histogram(pair));
        });
        return counts;
    };
    if (!capture.sequence) {
        result.transient = record_frame(0, capture.transient);
        return result;
    }
    result.sequence = capture.sequence;
    result.sequence->frames.clear();
    result.sequence->errors.clear();  // of light, not of what is recorded of it
    for (const core::Transient& light : capture.sequence->frames) {
        result.sequence->frames.push_back(record_frame(result.sequence->frames.size(), light));
    }
    result.transient = result.sequence->frames.back();
    return result;
}

}  // namespace nlos
