// SPDX-License-Identifier: MIT
#include "nlos/preparation/checks/capture_check.h"

#include "nlos/preparation/capture_faults.h"
#include "nlos/preparation/checks/capture_correction.h"
#include "nlos/preparation/checks/wall_unit.h"
#include "nlos/preparation/first_light.h"
#include "nlos/preparation/histogram_preparation.h"
#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/statistics.h"
#include "renderer/core/system/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace nlos {
namespace {

constexpr double kEarlyFraction = 0.01;   // of all light
constexpr double kNoiseDeviations = 5.0;  // of counts: less may be noise
constexpr double kFastestOnset = 1.25;    // of what is possible, for half of all neighbours
constexpr std::size_t kMinCheckedPoints = 16;
constexpr std::size_t kSteps = 8;  // neighbours are so many to a side: noise moves onsets little
constexpr double kStrongestBend = 1.15;     // of first light: 1 is what a path allows
constexpr double kWeakestBend = 0.7;        // edges and tips reach 1
constexpr double kBendOfAPlane = 0.1;       // says nothing
constexpr double kCheckSignificance = 3.0;  // standard deviations
constexpr double kFainterFraction = 0.1;    // of a maximum, beside kFirstLightFraction
constexpr double kFactorTolerance = 0.15;   // of what first light says of lengths
constexpr std::size_t kMinLitValues = 16;   // fewer may be whole numbers by chance

/// Constant background of each pair; 0 where it cannot be told.
std::vector<double> ambient_of(const core::Capture& capture) {
    auto signal = find_signal(capture.transient, capture.observed, capture.unit);
    if (signal && (capture.unit == core::TransientUnit::Counts || signal->has_background)) {
        return std::move(signal->ambient_per_bin);
    }
    return std::vector<double>(capture.scan.num_pairs(), 0.0);
}

/// Light above the background, all of it and what arrives before the shortest possible path.
struct EarlyLight {
    double all = 0.0;
    double early = 0.0;
    double early_counts = 0.0;  ///< with the background
    double earliest_m = 0.0;    ///< before that path

    EarlyLight& operator+=(const EarlyLight& other) {
        all += other.all;
        early += other.early;
        early_counts += other.early_counts;
        earliest_m = std::max(earliest_m, other.earliest_m);
        return *this;
    }
};

EarlyLight early_light_of(const core::Capture& capture, std::size_t pair, double ambient) {
    const core::TimeAxis& axis = capture.time_axis;
    const core::WallScan& scan = capture.scan.wall();
    const double shortest = (scan.illumination_point(pair) - scan.sensing_point(pair)).norm() +
                            scan.device_segments_m(pair);
    const auto seen = capture.observed_values(pair);
    const Eigen::Map<const Eigen::ArrayXf> values(seen.data(),
                                                  static_cast<Eigen::Index>(seen.size()));
    EarlyLight light;
    light.all = values.cast<double>().sum() - ambient * static_cast<double>(seen.size());
    int end = capture.observed_range(pair).begin;
    for (const float count : seen) {
        const double before = shortest - axis.bin_begin_m(++end);
        if (before < axis.bin_width_m) break;
        const auto value = static_cast<double>(count);
        light.early += value - ambient;
        light.early_counts += value;
        if (value > ambient) light.earliest_m = std::max(light.earliest_m, before);
    }
    return light;
}

/// Light, above the background, in bins that end before the shortest possible path. That of a patch
/// of the wall, which a sensor's zone sees, is not known here.
std::optional<std::string> early_light(const core::Capture& capture,
                                       const std::vector<double>& ambient) {
    if (core::recorded_sensor(capture)) return std::nullopt;
    const auto [all, early, early_counts, earliest_m] =
        core::parallel_sum<EarlyLight>(capture.scan.num_pairs(), {}, [&](std::size_t pair) {
            return early_light_of(capture, pair, ambient[pair]);
        });
    if (!(all > 0.0) || early < kEarlyFraction * all) return std::nullopt;
    if (capture.unit == core::TransientUnit::Counts &&
        early < kNoiseDeviations * std::sqrt(early_counts)) {
        return std::nullopt;
    }
    return fmt::format(
        "{:.1f} % of the light arrives before the shortest possible path, up to "
        "{:.3g} m early; time zero looks late (capture.opl_shift_m moves it)",
        100.0 * early / all,
        earliest_m);
}

/// Whether a histogram's peak stands so far above its background that first light, a fraction of
/// it, is no noise.
bool has_clear_onset(const core::Capture& capture, std::size_t pair, double ambient) {
    if (capture.unit != core::TransientUnit::Counts) return true;
    const auto histogram = capture.transient.histogram(pair);
    const auto peak = static_cast<double>(*std::max_element(histogram.begin(), histogram.end()));
    return kFirstLightFraction * (peak - ambient) >
           kNoiseDeviations * std::sqrt(std::max(1.0, ambient));
}

/// First light that moves along the wall faster than path lengths can.
std::optional<std::string> fast_onset(const core::Capture& capture,
                                      const std::vector<double>& ambient,
                                      const std::vector<std::optional<double>>& first_light) {
    const core::WallScan& scan = capture.scan.wall();
    if (!scan.sensing.grid) return std::nullopt;
    const auto [nx, ny] = *scan.sensing.grid;
    if (nx < kMinCheckedPoints || ny < kMinCheckedPoints) return std::nullopt;
    std::vector<std::optional<double>> onsets(nx * ny);
    for (std::size_t i = 0; i < onsets.size(); ++i) {
        if (has_clear_onset(capture, i, ambient[i])) {
            onsets[i] = first_light[i];
        }
    }
    const double most = scan.pattern == core::ScanPattern::Confocal ? 2.0 : 1.0;
    std::vector<double> speeds;
    const auto compare = [&](std::size_t a, std::size_t b) {
        if (!onsets[a] || !onsets[b]) return;
        const double moved = std::abs(*onsets[a] - *onsets[b]) - capture.time_axis.bin_width_m;
        const double distance = (scan.sensing.positions[a] - scan.sensing.positions[b]).norm();
        if (distance > 0.0) speeds.push_back(moved / (most * distance));
    };
    for (std::size_t ix = 0; ix < nx; ++ix) {
        for (std::size_t iy = 0; iy < ny; ++iy) {
            if (ix + nx / kSteps < nx) compare(ix * ny + iy, (ix + nx / kSteps) * ny + iy);
            if (iy + ny / kSteps < ny) compare(ix * ny + iy, ix * ny + iy + ny / kSteps);
        }
    }
    if (speeds.size() < nx * ny / 2) return std::nullopt;
    const double speed = core::upper_median(std::move(speeds));
    if (speed < kFastestOnset) return std::nullopt;
    return fmt::format(
        "first light moves along the wall {:.2f} times as fast as a path length can "
        "change; bins look narrower than {:.4g} m (capture.bin_width_m sets them)",
        speed,
        capture.time_axis.bin_width_m);
}

/// How first light bends over the wall, which is wrong where bins or wall are, and
/// where several surfaces share a histogram and take turns in passing a fraction of its maximum. So
/// of two fractions, that which looks less wrong is believed.
std::optional<BendOfFirstLight> credible_bend(
    const core::Capture& capture,
    const std::vector<double>& ambient,
    const std::vector<std::optional<double>>& first_light) {
    const auto bend = bend_of_first_light(capture, first_light);
    if (!bend) return std::nullopt;
    const auto fainter =
        bend_of_first_light(capture, first_light_m(capture, ambient, kFainterFraction));
    const auto wrong = [](const BendOfFirstLight& of) { return std::abs(std::log(of.k)); };
    return fainter && fainter->k > 0.0 && wrong(*fainter) < wrong(*bend) ? fainter : bend;
}

/// First light that bends over the wall otherwise than that of points, edges and tips does.
std::optional<std::string> bent_onset(const core::Capture& capture,
                                      const std::optional<BendOfFirstLight>& bend) {
    if (!bend || bend->k < kBendOfAPlane) return std::nullopt;
    const double fitting_m = capture.time_axis.bin_width_m / std::sqrt(bend->k);
    if (bend->k - kCheckSignificance * bend->uncertainty > kStrongestBend) {
        return fmt::format(
            "first light bends over the wall {:.2f} times as much as a path length can; bins look "
            "narrower than {:.4g} m: {:.4g} m would fit (capture.bin_width_m sets them), or a wall "
            "{:.2f} times as large",
            bend->k,
            capture.time_axis.bin_width_m,
            fitting_m,
            std::sqrt(bend->k));
    }
    if (bend->k + kCheckSignificance * bend->uncertainty < kWeakestBend) {
        return fmt::format(
            "first light bends over the wall {:.2f} times as much as that of points, edges and "
            "tips; bins look wider than {:.4g} m: {:.4g} m would fit (capture.bin_width_m sets "
            "them), or a wall {:.2f} times as large, unless all that is hidden is round and large",
            bend->k,
            capture.time_axis.bin_width_m,
            fitting_m,
            std::sqrt(bend->k));
    }
    return std::nullopt;
}

/// Whether first light clearly bends by another factor than a correction of lengths makes up for.
bool disagrees(const BendOfFirstLight& bend, const CaptureCorrection& correction) {
    return correction.length_factor != 1.0 &&
           std::abs(std::sqrt(bend.k) * correction.length_factor - 1.0) > kFactorTolerance;
}

/// Whether first light would bend by more than any path length can if a correction held.
bool is_impossible(const BendOfFirstLight& bend, const CaptureCorrection& correction) {
    const double stretch = correction.length_factor / correction.wall_factor;
    const double least = bend.k - kCheckSignificance * bend.uncertainty;
    return stretch > 1.0 && stretch * stretch * least > kStrongestBend;
}

/// What mistakes in describing a capture would explain it, unless first light knows better.
std::optional<std::string> mistakes(const core::Capture& capture,
                                    const std::vector<double>& ambient,
                                    const std::optional<BendOfFirstLight>& bend) {
    const auto evidence = mistake_evidence(capture, ambient);
    if (!evidence) return std::nullopt;
    std::string text;
    for (const CaptureCorrection& correction : recognise_mistakes(*evidence)) {
        if (bend && bent_onset(capture, bend) && disagrees(*bend, correction)) continue;
        if (bend && is_impossible(*bend, correction)) continue;
        text += (text.empty() ? "" : "; or ") + describe_mistake(capture, correction);
    }
    if (text.empty()) return std::nullopt;
    return "set-up: " + text;
}

/// Counts that are called radiance, and radiance that is called counts.
std::optional<std::string> wrong_unit(const core::Capture& capture) {
    std::size_t lit = 0;
    std::size_t whole = 0;
    std::size_t several = 0;
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        int lit_here = 0;  // narrow counters and no branches: the loop runs over all of the data
        int whole_here = 0;
        int several_here = 0;
        for (const float value : capture.transient.histogram(pair)) {
            lit_here += static_cast<int>(value != 0.0F);
            whole_here +=
                static_cast<int>(value > 0.0F) & static_cast<int>(value == std::trunc(value));
            several_here += static_cast<int>(value >= 2.0F);
        }
        lit += static_cast<std::size_t>(lit_here);
        whole += static_cast<std::size_t>(whole_here);
        several += static_cast<std::size_t>(several_here);
    }
    if (capture.unit == core::TransientUnit::Radiance && whole == lit && lit >= kMinLitValues &&
        several > 0) {
        return "radiance that is whole numbers throughout looks like counts: --set "
               "capture.unit=counts";
    }
    if (capture.unit == core::TransientUnit::Counts && 2 * whole < lit) {
        return "counts that are no whole numbers look like radiance: --set "
               "capture.unit=radiance";
    }
    return std::nullopt;
}

/// Light that the renderer knows to lie outside the axis.
std::optional<std::string> cut_light(const core::Capture& capture) {
    constexpr double kMostMissing = 0.01;
    const core::Json& made = *capture.scene_info;
    if (!made.is_object() || !made.contains("light") || !made["light"].is_object()) return {};
    const core::Json fraction = made["light"].value("share_in_axis", core::Json());
    if (!fraction.is_number() || fraction.get<double>() >= 1.0 - kMostMissing) return {};
    return fmt::format(
        "the capture is cut by its gate: {:.4g} to {:.4g} m of path length hold "
        "{:.2g} % of the scene's light",
        capture.time_axis.opl_start_m,
        capture.time_axis.opl_end_m(),
        100.0 * fraction.get<double>());
}

/// Counts from which a background was taken off.
std::optional<std::string> negative_counts(const core::Capture& capture) {
    if (capture.unit != core::TransientUnit::Counts) return std::nullopt;
    const auto values = capture.transient.values();
    const auto negative = std::ranges::count_if(values, [](float value) { return value < 0.0F; });
    if (negative == 0) return std::nullopt;
    return fmt::format(
        "{:.2g} % of the counts are negative, as if a background had been taken off: their noise "
        "is not known, and solver and fits take least squares instead of Poisson's likelihood; "
        "give the counts as recorded, or --set capture.unit=radiance",
        100.0 * static_cast<double>(negative) / static_cast<double>(values.size()));
}

/// What looks wrong about a capture without faulty bins and points.
std::vector<std::string> description_warnings(const core::Capture& capture) {
    std::vector<std::string> warnings;
    if (auto warning = cut_light(capture)) warnings.push_back(*warning);
    if (auto warning = wrong_unit(capture)) warnings.push_back(*warning);
    if (auto warning = negative_counts(capture)) warnings.push_back(*warning);
    if (!capture.scan.has_wall()) return warnings;
    if (auto warning = wall_unit_mistake(capture)) {
        warnings.push_back(*warning);
        return warnings;  // nothing else about the wall makes sense
    }
    const std::vector<double> ambient = ambient_of(capture);
    const auto early = early_light(capture, ambient);
    if (early && capture.time_axis.opl_start_m < -capture.time_axis.bin_width_m) {
        warnings.push_back(*early);
        return warnings;  // no scale makes negative lengths positive
    }
    const std::vector<std::optional<double>> first_light = first_light_m(capture, ambient);
    const auto bend = credible_bend(capture, ambient, first_light);
    if (auto warning = mistakes(capture, ambient, bend)) {
        warnings.push_back(*warning);
        return warnings;
    }
    if (early) warnings.push_back(*early);
    if (auto warning = fast_onset(capture, ambient, first_light)) {
        warnings.push_back(*warning);
    } else if (auto other = bent_onset(capture, bend)) {
        warnings.push_back(*other);
    }
    return warnings;
}

}  // namespace

std::vector<std::string> capture_warnings(const core::Capture& capture) {
    const auto& sequence = capture.sequence;
    const bool other_frames_are_lit =
        sequence && !std::all_of(sequence->frames.begin(),
                                 sequence->frames.end(),
                                 [](const core::Transient& frame) { return frame.is_dark(); });
    if (core::observed_hull(capture.observed, capture.time_axis.num_bins).size() == 0) {
        return {"no bin of any pair was observed"};
    }
    if (capture.transient.is_dark() && !other_frames_are_lit) {
        return {"the capture holds no light: all its values are 0"};
    }
    const CaptureFaults faults = find_faults(capture);
    if (faults.empty()) return description_warnings(capture);
    std::vector<std::string> warnings = description_warnings(leave_out(faults, capture));
    warnings.insert(warnings.begin(), *describe(faults));
    return warnings;
}

}  // namespace nlos
