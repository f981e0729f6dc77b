// SPDX-License-Identifier: MIT
#include "calib/fit.h"

#include "calib/fit_driver.h"
#include "calib/poisson_deviance.h"
#include "calib/uncertainty.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace calib {
namespace {

using core::Vec3;

constexpr int kScoutIterations = 8;     // of each of many starts, on the coarsest data
constexpr std::size_t kKeptStarts = 3;  // that go on to the second stage
constexpr double kDegrees = 180.0 / core::kPi;

struct Candidate {
    std::string name;
    SceneState state;
    SolveSummary summary;
};

void sort_by_cost(std::vector<Candidate>& candidates) {
    std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
        return a.summary.cost < b.summary.cost;
    });
}

// All starts go through coarse stages with fewer and fewer of them; one reaches the last.
Candidate run_stages(const FitDriver& driver,
                     const FitInput& input,
                     const core::Progress& progress,
                     FitDriver::Stage& last,
                     FitResult& result) {
    std::vector<Candidate> candidates;
    for (auto& [name, state] : driver.starts()) candidates.push_back({name, state, {}});
    const auto& schedule = input.settings.blur_schedule_m;
    for (std::size_t s = 0; s + 1 < schedule.size(); ++s) {
        FitDriver::Stage stage = driver.make_stage(schedule[s]);
        const bool is_scouting = candidates.size() > 1;
        for (Candidate& candidate : candidates) {
            progress.update(static_cast<double>(s) / static_cast<double>(schedule.size()),
                            fmt::format("blur {:g} m, {}", schedule[s], candidate.name));
            candidate.summary =
                driver.solve(stage,
                             candidate.state,
                             is_scouting ? kScoutIterations : input.settings.max_iterations);
            result.iterations += candidate.summary.iterations;
        }
        sort_by_cost(candidates);
        if (result.starts.empty()) {
            for (const Candidate& c : candidates) result.starts.push_back({c.name, c.summary.cost});
        }
        const std::size_t kept = s == 0 ? kKeptStarts : 1;
        if (candidates.size() > kept) candidates.resize(kept);
    }
    for (Candidate& candidate : candidates) {
        candidate.summary = driver.solve(last, candidate.state, input.settings.max_iterations);
        result.iterations += candidate.summary.iterations;
    }
    sort_by_cost(candidates);
    if (result.starts.empty()) {
        for (const Candidate& c : candidates) result.starts.push_back({c.name, c.summary.cost});
    }
    return candidates.front();
}

// Reads one column's standard deviation from where a block stands.
class Sigmas {
 public:
    Sigmas(const SceneModel& model, const Uncertainty& uncertainty)
        : model_(model), uncertainty_(uncertainty) {}

    double at(ParameterKind kind, std::size_t item = 0, int offset = 0) const {
        const ParameterBlock* block = model_.find(kind, item);
        return block == nullptr ? kFixed : uncertainty_.sigma[block->first_column + offset];
    }
    Vec3 vector(ParameterKind kind, std::size_t item) const {
        return {at(kind, item, 0), at(kind, item, 1), at(kind, item, 2)};
    }

 private:
    const SceneModel& model_;
    const Uncertainty& uncertainty_;
};

void store_objects(const FitInput& input,
                   const SceneModel& model,
                   const SceneState& state,
                   const Sigmas& sigmas,
                   FitResult& result) {
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
        const ModelBody& body = model.bodies()[b];
        const BodyState& s = state.bodies[b];
        const auto& node = input.geometry.objects[body.objects.front()].world_from_node;
        FittedObject& object = result.objects.emplace_back();
        object.name = body.name;
        object.position_m = s.position_m;
        object.rotation = (s.rotation * Eigen::Quaterniond(node.rotation())).normalized();
        if (object.rotation.w() < 0.0) object.rotation.coeffs() *= -1.0;
        object.size = std::exp(s.log_size);
        object.albedo = std::exp(s.log_albedo);
        object.heights_m = s.heights_m;
        object.position_sigma_m = sigmas.vector(ParameterKind::Translation, b);
        object.rotation_sigma_deg = kDegrees * sigmas.vector(ParameterKind::Rotation, b);
        object.size_sigma = object.size * sigmas.at(ParameterKind::Size, b);
        object.albedo_sigma = object.albedo * sigmas.at(ParameterKind::Albedo, b);
        for (std::size_t v = 0; v < s.heights_m.size(); ++v) {
            object.heights_sigma_m.push_back(
                sigmas.at(ParameterKind::Heights, b, static_cast<int>(v)));
        }
    }
    for (std::size_t i = 0; i < state.points.size(); ++i) {
        FittedPoint& point = result.points.emplace_back();
        point.position_m = state.points[i].position_m;
        point.albedo = std::exp(state.points[i].log_albedo);
        point.position_sigma_m = sigmas.vector(ParameterKind::PointPosition, i);
        point.albedo_sigma = point.albedo * sigmas.at(ParameterKind::PointAlbedo, i);
    }
}

void store_rest(const FitInput& input,
                const SceneState& state,
                const Sigmas& sigmas,
                FitResult& result) {
    result.time_zero_m = {state.time_zero_m, sigmas.at(ParameterKind::TimeZero)};
    const double fwhm = input.settings.response.jitter_fwhm_ps * std::exp(state.log_width);
    result.response_fwhm_ps = {fwhm, fwhm * sigmas.at(ParameterKind::ResponseWidth)};
    result.wall_bow_m = {state.bow_m, sigmas.at(ParameterKind::WallBow)};
    const double wall = std::exp(state.log_wall_scale);
    result.wall_scale = {wall, wall * sigmas.at(ParameterKind::WallScale)};
    const double scale = std::exp(state.log_scale);
    result.scale = {scale, scale * sigmas.at(ParameterKind::Scale)};
    if (state.has_ambient) {
        const double ambient = std::exp(state.log_ambient);
        result.ambient = {ambient, ambient * sigmas.at(ParameterKind::Ambient)};
    }
}

// What the final model says of every bin, and how well that agrees with the data.
void store_fit(const FitDriver& driver,
               const FitDriver::Stage& stage,
               const SceneState& state,
               FitResult& result) {
    result.axis = stage.data.axis;
    result.data = stage.data.values;
    stage.model->update(state, core::Slopes::Without);
    const auto bins = static_cast<double>(stage.model->settings().bins_per_ambient);
    double variance = 0.0;
    PairModel expected;
    for (std::size_t pair = 0; pair < stage.objective->num_pairs(); ++pair) {
        stage.model->evaluate(pair, expected);
        for (double& value : expected.mean) {
            if (!driver.is_poisson()) {
                value = stage.objective->scale() * value + stage.objective->ambient();
            }
            const double counted = stage.data.values[result.model.size()];
            result.model.push_back(value);
            if (!driver.is_poisson()) {
                result.deviance += (value - counted) * (value - counted);
                continue;
            }
            const double mean = std::max(value, stage.data.least_mean);
            const double residual = signed_deviance(mean, counted).value;
            const DevianceMoments moments = deviance_moments(mean);
            result.deviance += residual * residual;
            result.expected_deviance += moments.mean;
            variance += moments.variance;
        }
    }
    result.expected_deviance_sigma = std::sqrt(variance);
    if (!driver.is_poisson()) {
        result.scale.value = stage.objective->scale();
        result.ambient.value = stage.objective->ambient() / bins;
        result.expected_deviance = result.deviance;
    }
}

Eigen::MatrixXd information_of(const FitDriver& driver,
                               FitDriver::Stage& stage,
                               const SceneState& state) {
    stage.objective->evaluate(state, core::Slopes::With);
    const std::vector<double> weights = loss_weights(*stage.objective, driver.solve_settings());
    const Eigen::MatrixXd prior = prior_information(driver.model(), driver.solve_settings());
    if (driver.is_poisson()) return stage.objective->fisher(state, weights) + prior;
    const auto size = driver.model().num_columns();
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t i = 0; i < stage.objective->num_pairs(); ++i) {
        const auto& rows = stage.objective->pair(i).jacobian;
        sum += (weights.empty() ? 1.0 : weights[i]) * (rows.transpose() * rows);
    }
    const double freedom = std::max(1.0, static_cast<double>(stage.data.values.size()) - size);
    return sum * freedom / std::max(stage.objective->sum_of_squares(), 1e-300) + prior;
}

void add_warnings(const FitDriver& driver, const SceneState& state, FitResult& result) {
    const core::TimeAxis& axis = driver.data().axis;
    double most = 0.0;
    double cut = 0.0;
    const auto bins = static_cast<std::size_t>(result.axis.num_bins);
    for (std::size_t i = 0; i < result.model.size(); i += bins) {
        cut += result.model[i + bins - 1];
        for (std::size_t b = 0; b < bins; ++b) most = std::max(most, result.model[i + b]);
    }
    cut /= static_cast<double>(result.model.size() / bins);
    if (cut - result.ambient.value > 0.05 * most) {
        result.warnings.push_back(fmt::format(
            "the model's light reaches beyond the end of the time axis at {:.3f} m; what lies "
            "there is not fitted",
            axis.opl_end_m()));
    }
    if (state.has_ambient &&
        state.log_ambient < driver.solve_settings().lowest_log_ambient + 0.01) {
        result.warnings.push_back("ambient: at its lower bound");
    }
    if (driver.is_poisson()) {
        const double excess = (result.deviance - result.expected_deviance) /
                              std::max(result.expected_deviance_sigma, 1e-300);
        if (excess > 5.0) {
            result.warnings.push_back(fmt::format(
                "the deviance exceeds its expectation by {:.1f} standard deviations: the model "
                "does not explain the data, and true errors exceed the stated ones",
                excess));
        }
    }
    if (driver.scale_is_unknown()) {
        const std::string name =
            driver.has_fixed_albedo() ? driver.fixed_albedo() : result.objects.front().name;
        result.unidentifiable.push_back("scale with " + name +
                                        ".albedo: counts of unknown scale; the albedo stays at "
                                        "its start");
    }
}

}  // namespace

FitResult fit_scene(const FitInput& input, const core::Progress& progress) {
    const auto begin = std::chrono::steady_clock::now();
    const FitDriver driver(input, progress);
    FitResult result;
    FitDriver::Stage last = driver.make_stage(input.settings.blur_schedule_m.back());
    Candidate best = run_stages(driver, input, progress, last, result);
    last.model->refresh(best.state);

    const Uncertainty uncertainty =
        assess(information_of(driver, last, best.state), driver.model().column_names());
    const Sigmas sigmas(driver.model(), uncertainty);
    store_objects(input, driver.model(), best.state, sigmas, result);
    store_rest(input, best.state, sigmas, result);
    store_fit(driver, last, best.state, result);
    for (const Correlation& c : uncertainty.correlations) {
        result.correlations.push_back({c.a, c.b, c.value});
    }
    result.condition_number = uncertainty.condition_number;
    result.unidentifiable = uncertainty.unidentifiable;
    result.residual = driver.is_poisson() ? "poisson" : "least_squares";
    result.converged = best.summary.converged;
    result.message = best.summary.message;
    result.num_pieces = last.model->num_pieces();
    result.geometry = driver.model().posed(best.state);
    add_warnings(driver, best.state, result);
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return result;
}

}  // namespace calib
