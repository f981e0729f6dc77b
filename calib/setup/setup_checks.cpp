// SPDX-License-Identifier: MIT
#include "calib/setup/setup_checks.h"

#include "calib/setup/misreadings.h"
#include "renderer/core/error.h"
#include "renderer/core/statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

constexpr double kBeyondChance = 5.0;  // standard deviations
constexpr double kMadPerSigma = 0.6745;

// Whether noise alone would hardly give so large a sum of squares.
bool is_beyond_chance(double chi_square, double degrees) {
    if (degrees < 1.0) return false;
    const double variance = 2.0 / (9.0 * degrees);
    return std::cbrt(chi_square / degrees) - (1.0 - variance) > kBeyondChance * std::sqrt(variance);
}

// The same sum where light may have been sorted into bins before the response spread it, and the
// camera is known no better than its boards show.
double lenient_chi_square(const SetupObservations& o, const SetupFit& fit) {
    double sum = fit.chi_square;
    for (std::size_t i = 0; i < o.returns.size(); ++i) {
        if (!o.counts(i)) continue;
        sum += std::pow(fit.length_misfit_m[i] / length_error_m(o, i), 2.0) -
               std::pow(fit.length_misfit_m[i] / o.returns[i].sigma_m, 2.0);
        if (!o.camera) continue;
        sum += std::pow(fit.spot_misfit_px[i] / spot_error_px(o), 2.0) -
               std::pow(fit.spot_misfit_px[i] / o.spot_sigma_px, 2.0);
    }
    return sum;
}

bool is_sound(const SetupObservations& o, const SetupFit& fit) {
    return !is_beyond_chance(lenient_chi_square(o, fit), fit.degrees_of_freedom);
}

std::string misfit_text(const SetupObservations& o, const SetupFit& fit) {
    std::string text = fmt::format(
        "path lengths are off by {:.3g} mm rms where counting explains "
        "{:.2g} mm",
        1e3 * fit.length_rms_m,
        1e3 * fit.noise_rms_m);
    if (o.camera) {
        text += fmt::format(
            ", spots by {:.3g} px where spot_sigma_px is {:.3g}", fit.spot_rms_px, o.spot_sigma_px);
    }
    return text;
}

std::vector<std::size_t> far_off(const SetupObservations& o, const SetupFit& fit) {
    constexpr double kFar = 6.0;  // standard deviations of noise or of the usual point
    const std::vector<double> misfits = point_misfits(o, fit);
    const double usual = std::max(1.0, core::median(misfits) / kMadPerSigma);
    std::vector<std::size_t> points;
    for (std::size_t i = 0; i < misfits.size(); ++i) {
        if (misfits[i] > kFar * usual) points.push_back(i);
    }
    return points;
}

SetupObservations without(const SetupObservations& o, const std::vector<std::size_t>& points) {
    SetupObservations rest = o;
    rest.left_out.assign(o.returns.size(), false);
    for (const std::size_t point : points) rest.left_out[point] = true;
    return rest;
}

// Points far from where all others put them. More than a quarter are no outliers.
std::vector<std::size_t> find_outliers(const SetupObservations& o, const SetupFit& fit) {
    constexpr int kMostRounds = 5;
    constexpr double kLeastFreedom = 3.0;
    if (!fit.is_found()) return {};
    std::vector<std::size_t> points = far_off(o, fit_setup_robustly(o, fit));
    for (int round = 0; round < kMostRounds && !points.empty(); ++round) {
        if (4 * points.size() > o.returns.size()) return {};
        const SetupFit rest = fit_setup(without(o, points));
        if (!rest.is_found() || rest.degrees_of_freedom < kLeastFreedom) return {};
        std::vector<std::size_t> again = far_off(o, rest);
        if (again == points) break;
        points = std::move(again);
    }
    return points;
}

// The observations without one of the known values.
SetupObservations without_known(const SetupObservations& o, const KnownKey& key) {
    SetupObservations others = o;
    (others.*key.value).reset();
    return others;
}

// The least misfit that is left when one of the known values is not believed.
double reduced_without_known(const SetupObservations& o) {
    double least = std::numeric_limits<double>::infinity();
    for (const KnownKey& key : kKnownKeys) {
        if (!(o.*key.value)) continue;
        const SetupFit free = fit_setup(without_known(o, key));
        if (free.is_found() && free.degrees_of_freedom >= 1.0) {
            least = std::min(least, free.reduced());
        }
    }
    return least;
}

// A misreading is named when it is worth far more than any chance, nearly all of the misfit, and no
// less than not to believe what is known.
void refuse_misreadings(const SetupObservations& o, const SetupFit& fit) {
    constexpr double kFarBetter = 9.0;
    constexpr double kLeastFreedom = 3.0;
    if (fit.is_found() && (fit.degrees_of_freedom < kLeastFreedom ||
                           !is_beyond_chance(fit.chi_square, fit.degrees_of_freedom))) {
        return;
    }
    double best_reduced = 2.0 * std::max(1.0, reduced_without_known(o));
    if (fit.is_found()) best_reduced = std::min(best_reduced, fit.reduced() / kFarBetter);
    std::string text;
    for (const Misreading& one : misreadings(o)) {
        const SetupFit other = fit_setup(one.corrected);
        if (!other.is_found() || !other.at_bound.empty() || !(other.reduced() < best_reduced)) {
            continue;
        }
        best_reduced = 0.5 * other.reduced();  // the likeliest come first
        text = fmt::format(
            "{}, which leaves {:.3g} mm; {}", one.looks, 1e3 * other.length_rms_m, one.help);
    }
    if (!fit.is_found()) {
        throw core::Failure(
            "calibrate",
            "no set-up whose beams all meet the wall explains the data" +
                (text.empty() ? "; `commands` or command_unit may be wrong" : ": " + text));
    }
    if (!text.empty()) throw core::Failure("calibrate", misfit_text(o, fit) + ": " + text);
}

// What the rest says of a known value, in standard deviations of both together.
void check_known(const SetupObservations& o, const SetupFit& fit, SetupVerdict& verdict) {
    constexpr double kContradiction = 10.0;
    for (const KnownKey& key : kKnownKeys) {
        const auto& known = o.*key.value;
        if (!known) continue;
        const SetupFit free = fit_setup(without_known(o, key));
        if (!free.is_found()) continue;
        const double noise = free.degrees_of_freedom >= 1.0 ? std::max(1.0, free.reduced()) : 1.0;
        const double sigmas = std::sqrt(std::max(0.0, fit.chi_square - free.chi_square) / noise);
        if (sigmas <= kBeyondChance) continue;
        const std::string text = fmt::format(
            "{} of {:.6g} +- {:.3g} is missed by {:.0f} standard deviations: direct returns, "
            "commands and what else is known ask for {:.4g}; correct it, or state a larger sigma",
            key.name,
            known->value,
            known->sigma,
            sigmas,
            free.values[static_cast<std::size_t>(key.parameters.front())]);
        if (sigmas > kContradiction) throw core::Failure("calibrate", text);
        verdict.warnings.push_back(text);
    }
}

// Path lengths of which the commands explain next to nothing are not those of the commands.
void refuse_unrelated(const SetupObservations& o, const SetupFit& fit) {
    constexpr double kUnrelated = 1.0 / 3.0;
    if (is_sound(o, fit)) return;
    double count = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < o.returns.size(); ++i) {
        if (!o.counts(i)) continue;
        count += 1.0;
        sum += o.returns[i].opl_m;
        squares += std::pow(o.returns[i].opl_m, 2.0);
    }
    const double spread_m = std::sqrt(std::max(0.0, squares / count - std::pow(sum / count, 2.0)));
    if (!(fit.length_rms_m > kUnrelated * spread_m)) return;
    throw core::Failure(
        "calibrate",
        fmt::format("{}, of a spread of {:.3g} mm: commands and direct returns do not belong "
                    "together; `commands` must stand in the order of the histograms, in "
                    "command_unit ({})",
                    misfit_text(o, fit),
                    1e3 * spread_m,
                    core::enum_name(o.command_unit)));
}

std::string outlier_text(const SetupObservations& o,
                         const SetupFit& rest,
                         const std::vector<std::size_t>& points,
                         OutlierRule rule) {
    constexpr std::size_t kMostNamed = 8;
    const std::vector<double> misfits = point_misfits(o, rest);
    std::string names;
    for (std::size_t i = 0; i < std::min(points.size(), kMostNamed); ++i) {
        names += fmt::format("{}{} by {:+.3g} mm",
                             i == 0 ? "" : ", ",
                             points[i],
                             -1e3 * rest.length_misfit_m[points[i]]);
    }
    return fmt::format("{} of {} points are far from where the others put them ({}{}){}",
                       points.size(),
                       o.returns.size(),
                       names,
                       points.size() > kMostNamed ? ", ..." : "",
                       rule == OutlierRule::LeaveOut ? " and are left out"
                                                     : "; outliers=leave_out leaves them out");
}

}  // namespace

SetupVerdict judge_setup(const SetupObservations& o, OutlierRule rule) {
    SetupVerdict verdict;
    verdict.fit = fit_setup(o);
    verdict.outliers = find_outliers(o, verdict.fit);
    const SetupObservations rest = without(o, verdict.outliers);
    const SetupFit rest_fit = verdict.outliers.empty() ? verdict.fit : fit_setup(rest);
    refuse_misreadings(rest, rest_fit);
    check_known(rest, rest_fit, verdict);
    refuse_unrelated(rest, rest_fit);
    if (!verdict.outliers.empty()) {
        verdict.warnings.push_back(outlier_text(o, rest_fit, verdict.outliers, rule));
    }
    if (rule == OutlierRule::LeaveOut) verdict.fit = rest_fit;
    const SetupObservations& used = rule == OutlierRule::LeaveOut ? rest : o;
    if (is_sound(used, verdict.fit)) return verdict;
    verdict.sigma_scale = std::max(1.0, std::sqrt(verdict.fit.reduced()));
    if (!is_sound(rest, rest_fit)) {
        verdict.warnings.push_back(
            fmt::format("{}: the wall may not be flat, the beams not where the commands send them, "
                        "or the peaks not of the shape of `response`; reported errors are {:.3g} "
                        "times larger for it, and true ones may exceed them",
                        misfit_text(rest, rest_fit),
                        verdict.sigma_scale));
    }
    return verdict;
}

}  // namespace calib
