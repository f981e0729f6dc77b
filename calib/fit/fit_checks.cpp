// SPDX-License-Identifier: MIT
#include "calib/fit/solution.h"
#include "calib/statistics/poisson_deviance.h"
#include "renderer/core/capture/recorded_detector.h"
#include "renderer/core/statistics.h"

#include <Eigen/Dense>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

// What a fit says of itself where its reported errors are not the whole truth.
//
// * A start behind the wall, or without light on the time axis: refused, with the range of lengths.
// * Light of the model that leaves the data, or data that hold none: not converged, and why.
// * Light beyond either end of the axis: fitted where it is. Blurred stages leave out what the cut
//   spoils.
// * Nearly symmetric objects: the better of the poses; a warning within a deviance of 9.
// * Fewer than 50 photons per parameter: bodies are tried turned by quarters and halves, and errors
//   come from refits to simulated counts.
// * A wrong response width, time zero, bow or scale: score tests, of what one Newton step would
//   change, beyond 5 standard deviations.
// * Wall points far off: named; `loss: huber` or `cauchy` gives them little weight.
// * A model that does not explain the data: deviance beyond its expectation; of least squares a
//   residual that is alike from bin to bin.
// * A free time zero without a prior: unidentifiable beside depth.

namespace calib {
namespace {

constexpr std::size_t kMaxNamed = 8;

void warn_of_cut_light(const core::TimeAxis& axis, double ambient, FitResult& result) {
    constexpr double kNotableFraction = 0.05;
    const auto bins = static_cast<std::size_t>(result.axis.num_bins);
    const auto pairs = static_cast<double>(result.model.size() / bins);
    double most = 0.0;
    double first = 0.0;
    double last = 0.0;
    for (std::size_t i = 0; i < result.model.size(); i += bins) {
        first += result.model[i] / pairs;
        last += result.model[i + bins - 1] / pairs;
        for (std::size_t b = 0; b < bins; ++b) most = std::max(most, result.model[i + b]);
    }
    const auto warn = [&](double light, const char* end, double opl_m) {
        if (light - ambient <= kNotableFraction * most) return;
        result.warnings.push_back(fmt::format(
            "the model's light reaches beyond the {} of the time axis at {:.3f} m; what "
            "lies there is not fitted",
            end,
            opl_m));
    };
    warn(first, "begin", axis.opl_start_m);
    warn(last, "end", axis.opl_end_m());
}

struct Excess {
    double deviance = 0.0;
    double expected = 0.0;
    double variance = 0.0;
    double sigmas() const { return (deviance - expected) / std::sqrt(std::max(variance, 1e-300)); }
};

// Deviance per pair against its expectation.
std::vector<Excess> pair_excesses(const FitResult& result, double min_mean) {
    const auto bins = static_cast<std::size_t>(result.axis.num_bins);
    std::vector<Excess> excesses(result.model.size() / bins);
    for (std::size_t i = 0; i < result.model.size(); ++i) {
        const auto bin = static_cast<int>(i % bins);
        if (!core::observed_range(result.observed, i / bins, result.axis.num_bins).holds(bin)) {
            continue;
        }
        const double mean = std::max(result.model[i], min_mean);
        const DevianceMoments moments = deviance_moments(mean);
        Excess& pair = excesses[i / bins];
        pair.deviance += std::pow(signed_deviance(mean, result.data[i]).value, 2.0);
        pair.expected += moments.mean;
        pair.variance += moments.variance;
    }
    return excesses;
}

// Wall points far off are named, since a loss or their removal helps against them alone; the rest
// says whether the model is right elsewhere.
void warn_of_deviance(const FitDriver& driver, double min_mean, FitResult& result) {
    constexpr double kWild = 8.0;         // standard deviations
    constexpr double kWildOfUsual = 6.0;  // of the median pair's
    Excess rest;
    std::string names;
    std::size_t wild = 0;
    const std::vector<Excess> excesses = pair_excesses(result, min_mean);
    std::vector<double> sizes;
    for (const Excess& pair : excesses) sizes.push_back(std::abs(pair.sigmas()));
    const double limit = std::max(kWild, kWildOfUsual * core::upper_median(std::move(sizes)));
    for (std::size_t i = 0; i < excesses.size(); ++i) {
        const Excess& pair = excesses[i];
        if (pair.sigmas() > limit) {
            if (wild < kMaxNamed) names += fmt::format("{}{}", wild == 0 ? "" : ", ", i);
            ++wild;
            continue;
        }
        rest.deviance += pair.deviance;
        rest.expected += pair.expected;
        rest.variance += pair.variance;
    }
    const bool are_outliers = wild > 0 && 4 * wild <= excesses.size();
    if (are_outliers) {
        const bool has_loss = driver.settings.loss != LossKind::None;
        result.warnings.push_back(fmt::format(
            "{} of {} pairs do not fit at all ({}{}): {}",
            wild,
            excesses.size(),
            names,
            wild > kMaxNamed ? ", ..." : "",
            has_loss
                ? "the loss gives them little weight"
                : "true errors exceed the reported ones; loss: cauchy gives them little weight"));
    }
    const double excess = are_outliers ? rest.sigmas()
                                       : (result.deviance - result.expected_deviance) /
                                             std::max(result.expected_deviance_sigma, 1e-300);
    if (excess <= kNotableExcess) return;
    result.warnings.push_back(
        fmt::format("the deviance exceeds its expectation by {:.1f} standard deviations: the model "
                    "does not explain the data, and true errors exceed the reported ones",
                    excess));
}

// Data that ambient light alone explains nearly as well hold none of the model's.
void check_for_light(double min_mean, FitResult& result) {
    double total = 0.0;
    for (const double value : result.data) total += value;
    const double mean = std::max(total / static_cast<double>(result.num_observed()), min_mean);
    double dark = 0.0;
    for (const double value : result.data) dark += std::pow(signed_deviance(mean, value).value, 2);
    // Bins that were not observed hold 0 and do not count.
    const std::size_t unseen = result.data.size() - result.num_observed();
    dark -= static_cast<double>(unseen) * std::pow(signed_deviance(mean, 0.0).value, 2);
    const double gain = dark - result.deviance;
    const double by_chance = 25.0 + 2.0 * static_cast<double>(result.parameters.size());
    if (gain > by_chance) return;
    result.converged = false;
    result.message = fmt::format(
        "ambient light alone explains the data nearly as well (deviance {:.1f} more): they hold no "
        "light that the model could be fitted to",
        gain);
}

// A residual that is alike from bin to bin and large comes from a model that is none of the scene.
void warn_of_patterns(FitResult& result) {
    constexpr double kNotableCorrelation = 0.3;
    constexpr double kNotableFraction = 1e-3;  // of the data's energy
    double energy = 0.0;
    for (const double value : result.data) energy += value * value;
    const double correlation = residual_correlation(result);
    if (correlation < kNotableCorrelation || result.deviance < kNotableFraction * energy) return;
    result.warnings.push_back(
        fmt::format("the residual holds {:.1f} % of the data's energy and is alike between "
                    "neighbours (correlation {:.2f}): the model does not explain the data, and "
                    "true errors exceed the reported ones",
                    100.0 * result.deviance / energy,
                    correlation));
}

void warn_of_high_values(const SceneModel& model, FitResult& result) {
    for (const ParameterBlock& block : model.blocks()) {
        if (block.row->owner != Owner::Body || block.row->key == nullptr) continue;
        const FittedObject& object = result.objects[block.item];
        const double value = object.numbers[block.row->key].value;
        if (!(value > block.row->highest)) continue;
        result.warnings.push_back(fmt::format(
            "{}: its {} of {:.3f} is above {:g}: data or units are not what the model assumes",
            object.name,
            block.row->name,
            value,
            block.row->highest));
    }
}

// Whole objects at one place are most likely one that was added twice.
void warn_of_coincident_bodies(const FitDriver& driver, FitResult& result) {
    std::vector<renderer::Object> objects = driver.geometry.objects;
    const double tolerance_m =
        renderer::coincidence_m(objects, driver.input.capture.scan.path_ends());
    for (const renderer::CoincidentFaces& faces : renderer::leave_out_covered_faces(
             objects, renderer::FacePrecedence(objects), tolerance_m)) {
        if (faces.num_left_out < faces.num_faces) continue;
        result.warnings.push_back(
            fmt::format("{} starts at the place of {}, and both count, since one is free to move",
                        faces.object,
                        faces.by));
    }
}

}  // namespace

double residual_correlation(const FitAgreement& fit) {
    constexpr double kSignificance = 3.0;  // standard deviations of what chance gives
    const auto bins = static_cast<std::size_t>(fit.axis.num_bins);
    double squares = 0.0;
    double along_bins = 0.0;
    double along_pairs = 0.0;
    const auto residual = [&](std::size_t i) { return fit.data[i] - fit.model[i]; };
    for (std::size_t i = 0; i < fit.data.size(); ++i) {
        squares += residual(i) * residual(i);
        if (i % bins != 0) along_bins += residual(i) * residual(i - 1);
        if (i >= bins) along_pairs += residual(i) * residual(i - bins);
    }
    if (!(squares > 0.0)) return 0.0;
    const double correlation = std::max(std::abs(along_bins), std::abs(along_pairs)) / squares;
    const double chance = kSignificance / std::sqrt(static_cast<double>(fit.num_observed()));
    return correlation > chance ? std::min(1.0, correlation) : 0.0;
}

void add_warnings(const FitDriver& driver,
                  const FitDriver::Stage& stage,
                  const SceneState& state,
                  FitResult& result) {
    warn_of_cut_light(driver.data.axis, ambient_of(stage, state), result);
    if (auto text = core::detector_warning(driver.input.capture)) {
        result.warnings.push_back(std::move(*text));
    }
    for (const ParameterBlock& block : driver.model->blocks()) {
        const bool is_bounded = block.row->effect == Effect::AddsLight;
        if (is_bounded &&
            block.row->numbers(state)[0] < driver.solve_settings.lowest_log_ambient + 0.01) {
            result.warnings.push_back(block.names.front() + ": at its lower bound");
        }
    }
    warn_of_high_values(*driver.model, result);
    warn_of_coincident_bodies(driver, result);
    if (driver.is_poisson) {
        warn_of_deviance(driver, stage.data->min_mean, result);
        check_for_light(stage.data->min_mean, result);
        warn_of_misfits(driver, state, result);
    } else {
        warn_of_patterns(result);
    }
    if (driver.scale_is_unknown) {
        const std::string name =
            driver.fixed_albedo.empty() ? result.objects.front().name : driver.fixed_albedo;
        result.unidentifiable.push_back("scale with " + name +
                                        ".albedo: counts of unknown scale; the albedo stays at "
                                        "its start");
    }
}

void check_dependence(const SceneModel& model, FitResult& result) {
    for (const ParameterBlock& block : model.blocks()) {
        const bool is_position =
            block.row->effect == Effect::Translates || block.row->effect == Effect::Rotates;
        if (!is_position || result.sigma.segment(block.first_column, block.columns).allFinite())
            continue;
        result.converged = false;
        result.message = "the light of " +
                         block.names.front().substr(0, block.names.front().rfind('.')) +
                         " has left the data; start nearer, or use start: search";
        return;
    }
}

}  // namespace calib
