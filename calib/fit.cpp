// SPDX-License-Identifier: MIT
#include "calib/fit.h"

#include "calib/fit/fit_driver.h"
#include "calib/fit/recentred_fit.h"
#include "calib/fit/solution.h"
#include "calib/fit/stage_solver.h"
#include "calib/model/scene_model.h"
#include "calib/statistics/poisson_deviance.h"
#include "renderer/core/stopwatch.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace calib {
namespace {

using core::Vec3;

constexpr int kScoutIterations = 8;     // of each of many starts, on the coarsest data
constexpr std::size_t kKeptStarts = 3;  // that go on to the second stage

struct FitCandidate {
    std::string name;
    SceneState state;
    SolveSummary summary;
};

void sort_by_cost(std::vector<FitCandidate>& candidates) {
    std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
        return a.summary.cost < b.summary.cost;
    });
}

// What the model of a state says of every bin, and how well that agrees with the data.
FitAgreement compare_with_data(const FitDriver& driver,
                               const FitDriver::Stage& stage,
                               const SceneState& state) {
    FitAgreement result;
    result.axis = stage.data->axis;
    result.data = stage.data->values;
    result.observed = stage.data->observed;
    result.residual = driver.is_poisson ? "poisson" : "least_squares";
    stage.model->update(state, renderer::Gradients::Without);
    double variance = 0.0;
    PairModel expected;
    for (std::size_t pair = 0; pair < stage.objective->num_pairs(); ++pair) {
        stage.model->evaluate(pair, expected);
        const core::BinRange seen = stage.data->observed_range(pair);
        for (int bin = 0; bin < result.axis.num_bins; ++bin) {
            double& value = expected.mean[static_cast<std::size_t>(bin)];
            if (!seen.holds(bin)) {
                result.model.push_back(0.0);
                continue;
            }
            if (!driver.is_poisson) {
                value = stage.objective->scale() * value + stage.objective->ambient();
            }
            const double counted = stage.data->values[result.model.size()];
            result.model.push_back(value);
            if (!driver.is_poisson) {
                result.deviance += (value - counted) * (value - counted);
                continue;
            }
            const double mean = std::max(value, stage.data->min_mean);
            const double residual = signed_deviance(mean, counted).value;
            const DevianceMoments moments = deviance_moments(mean);
            result.deviance += residual * residual;
            result.expected_deviance += moments.mean;
            variance += moments.variance;
        }
    }
    result.expected_deviance_sigma = std::sqrt(variance);
    if (!driver.is_poisson) result.expected_deviance = result.deviance;
    return result;
}

// Solves one after another, and tells how far that is.
class SolveSeries {
 public:
    SolveSeries(const FitDriver& driver, const core::Progress& progress, std::size_t num_solves)
        : driver_(driver), progress_(progress), num_solves_(num_solves) {}

    void solve(FitDriver::Stage& stage,
               int max_iterations,
               FitCandidate& candidate,
               FitCourse& course) {
        const double fraction =
            static_cast<double>(num_done_) /
            static_cast<double>(std::max<std::size_t>(num_solves_, num_done_ + 1));
        const auto report = [&](int iterations) {
            progress_.update(fraction, fmt::format("{}, iteration {}", candidate.name, iterations));
        };
        candidate.summary = driver_.solve(stage, candidate.state, max_iterations, report);
        course.iterations += candidate.summary.iterations;
        ++num_done_;
    }

    /// Solves one more candidate on the sharp data, and sorts it in.
    void add_solved(FitDriver::Stage& last,
                    FitCandidate candidate,
                    std::vector<FitCandidate>& candidates,
                    FitCourse& course) {
        solve(last, driver_.settings.max_iterations, candidate, course);
        candidates.push_back(std::move(candidate));
        sort_by_cost(candidates);
    }

 private:
    const FitDriver& driver_;
    const core::Progress& progress_;
    std::size_t num_solves_;
    std::size_t num_done_ = 0;
};

// Blur can merge what lies apart: a start that was given is then also solved without it.
void retry_without_blur(const FitDriver& driver,
                        FitDriver::Stage& last,
                        SolveSeries& series,
                        std::vector<FitCandidate>& candidates,
                        FitCourse& course) {
    const bool has_blur = driver.settings.blur_schedule_m.size() > 1;
    if (driver.settings.start != "given" || !has_blur || !driver.is_poisson) return;
    const FitAgreement fit = compare_with_data(driver, last, candidates.front().state);
    const double excess = fit.deviance - fit.expected_deviance;
    if (excess <= kNotableExcess * fit.expected_deviance_sigma) return;
    series.add_solved(
        last, {"given, without blur", driver.starts().front().second, {}}, candidates, course);
}

// Of sorted candidates, the best and others in other poses that blurred data tell from it no better
// than noise.
void keep_best(const SceneModel& model,
               std::size_t most,
               double tellable,
               std::vector<FitCandidate>& candidates) {
    const double limit = candidates.front().summary.cost + tellable;
    std::vector<FitCandidate> kept;
    for (FitCandidate& candidate : candidates) {
        const bool is_new = std::all_of(kept.begin(), kept.end(), [&](const FitCandidate& other) {
            return are_different_poses(model, other.state, candidate.state);
        });
        const bool is_good = kept.empty() || candidate.summary.cost < limit;
        if (is_new && is_good && kept.size() < most) kept.push_back(std::move(candidate));
    }
    candidates = std::move(kept);
}

// The stages of a fit, as its progress counts them: the starts, the data under every blur, and
// three on the sharp data.
class Stages {
 public:
    Stages(const FitSettings& settings, const core::Progress& progress)
        : progress_(progress), num_blurs_(static_cast<int>(settings.blur_schedule_m.size()) - 1) {}

    core::Progress starts() const { return stage(1, "starts"); }
    core::Progress blurred(std::size_t index, double blur_m) const {
        return stage(static_cast<int>(index) + 2, fmt::format("data blurred by {:g} m", blur_m));
    }
    core::Progress sharp() const { return stage(num_blurs_ + 2, "sharp data"); }
    core::Progress alike() const { return stage(num_blurs_ + 3, "poses that look alike"); }
    core::Progress uncertainty() const { return stage(num_blurs_ + 4, "uncertainty"); }

 private:
    core::Progress stage(int number, const std::string& name) const {
        const int count = num_blurs_ + 4;
        return progress_.stage(number, count, name, (number - 1.0) / count, 1.0 * number / count);
    }

    const core::Progress& progress_;
    int num_blurs_;
};

// Solves from all starts on blurred data, drops the worse ones stage by stage, and solves from the
// rest on the sharp data. Returns the solutions, best first.
std::vector<FitCandidate> run_stages(const FitDriver& driver,
                                     const Stages& stages,
                                     FitDriver::Stage& last,
                                     FitCourse& course) {
    constexpr double kAnyCost = std::numeric_limits<double>::infinity();
    constexpr double kTellableCost = 5.0;
    std::vector<FitCandidate> candidates;
    for (auto& [name, state] : driver.starts()) candidates.push_back({name, state, {}});
    if (driver.settings.start == "given") driver.check_light(last, candidates.front().state);
    const auto note_starts = [&] {
        if (!course.starts.empty()) return;
        for (const FitCandidate& c : candidates) course.starts.push_back({c.name, c.summary.cost});
    };
    const auto& schedule = driver.settings.blur_schedule_m;
    for (std::size_t s = 0; s + 1 < schedule.size(); ++s) {
        FitDriver::Stage stage = driver.make_stage(*driver.model, schedule[s]);
        if (!driver.is_usable(stage)) continue;
        const core::Progress progress = stages.blurred(s, schedule[s]);
        SolveSeries series(driver, progress, candidates.size());
        const bool is_scouting = candidates.size() > 1;
        for (FitCandidate& candidate : candidates) {
            series.solve(stage,
                         is_scouting ? kScoutIterations : driver.settings.max_iterations,
                         candidate,
                         course);
        }
        sort_by_cost(candidates);
        note_starts();
        keep_best(*driver.model, kKeptStarts, s == 0 ? kAnyCost : kTellableCost, candidates);
    }
    const core::Progress progress = stages.sharp();
    SolveSeries series(driver, progress, candidates.size());
    std::vector<FitCandidate> solved;
    for (FitCandidate& candidate : candidates) {
        series.add_solved(last, std::move(candidate), solved, course);
    }
    candidates = std::move(solved);
    note_starts();
    retry_without_blur(driver, last, series, candidates, course);
    return candidates;
}

// How large the errors of least squares are.
struct LeastSquaresNoise {
    double variance = 0.0;   ///< of each value of the data
    double inflation = 1.0;  ///< of variances, over what independent errors of that size give
};

// Errors that are independent average out over the n values of the data. Those of noise-free data
// do not: they are the capture's own error and that of the model's elements, alike in neighbours. A
// residual r that points along a parameter as a whole moves it by |r| sqrt((J^T J)^-1), n times the
// variance of independent errors, and by no more; the correlation says how much of it is like that.
LeastSquaresNoise noise_of(const FitAgreement& fit, Eigen::Index num_parameters) {
    const double freedom = std::max(
        1.0, static_cast<double>(fit.num_observed()) - static_cast<double>(num_parameters));
    const double correlation = residual_correlation(fit);
    const double inflation = 1.0 - correlation + correlation * freedom;
    return {fit.deviance / freedom * inflation, inflation};
}

// A nearly symmetric body may have ended in the wrong one of several minima: the others are tried,
// and named when the data cannot tell them apart.
void try_symmetric_poses(const FitDriver& driver,
                         const core::Progress& progress,
                         FitDriver::Stage& last,
                         std::vector<FitCandidate>& candidates,
                         FitCourse& course) {
    const FitCandidate best = candidates.front();
    const std::vector<NamedState> poses = driver.turned(best.state);
    SolveSeries series(driver, progress, poses.size());
    for (const auto& [name, state] : poses) {
        series.add_solved(last, {best.name + ", " + name, state, {}}, candidates, course);
    }
}

// Twice the difference of costs is the difference of deviances: 9 is three standard deviations.
void warn_of_ambiguity(const FitDriver& driver,
                       const std::vector<FitCandidate>& candidates,
                       FitResult& result) {
    constexpr double kTellable = 9.0;
    if (!driver.is_poisson || !result.converged) return;
    std::vector<SceneState> known{candidates.front().state};
    for (const FitCandidate& other : candidates) {
        const double excess = 2.0 * (other.summary.cost - candidates.front().summary.cost);
        const bool is_other = std::all_of(known.begin(), known.end(), [&](const SceneState& state) {
            return are_different_poses(*driver.model, state, other.state);
        });
        if (excess > kTellable || !is_other) continue;
        known.push_back(other.state);
        result.warnings.push_back(fmt::format(
            "the data hardly tell this from another pose ({}; deviance {:.1f} more): the reported "
            "errors hold for this one alone",
            other.name,
            excess));
    }
}

// The Fisher information holds for many photons: with few, sigma grows to the scatter of a
// parametric bootstrap.
void widen_sigma(const FitDriver& driver,
                 const FitDriver::Stage& last,
                 const SceneState& state,
                 const core::Progress& progress,
                 FitResult& result) {
    if (!driver.has_few_photons() || !result.sigma.allFinite()) return;
    const Eigen::VectorXd scatter = bootstrap_scatter(driver, last, state, progress);
    const Eigen::VectorXd grown = scatter.cwiseMax(result.sigma);
    const Eigen::VectorXd factor = grown.cwiseQuotient(result.sigma);
    result.covariance = factor.asDiagonal() * result.covariance * factor.asDiagonal();
    result.sigma = grown;
    double photons = 0.0;
    const double ambient = ambient_of(last, state);
    for (const double value : result.model) photons += value;
    photons -= ambient * static_cast<double>(result.num_observed());
    result.warnings.push_back(fmt::format(
        "only {:.0f} photons: the reported errors are those of refits to simulated data, "
        "and not normally distributed",
        photons));
}

FitResult fit_near_origin(const FitInput& input, const core::Progress& progress) {
    const core::Stopwatch watch;
    const Stages stages(input.settings, progress);
    const core::Progress preparing = stages.starts();
    const FitDriver driver(input, preparing);
    FitResult result;
    FitDriver::Stage last = driver.make_stage(*driver.model, input.settings.blur_schedule_m.back());
    std::vector<FitCandidate> candidates = run_stages(driver, stages, last, result);
    try_symmetric_poses(driver, stages.alike(), last, candidates, result);
    FitCandidate& best = candidates.front();
    const core::Progress assessing = stages.uncertainty();
    const RefinedSolution refined = refine(driver, last, best.state);
    static_cast<FitAgreement&>(result) = compare_with_data(driver, last, best.state);

    result.parameters = driver.model->column_names();
    Eigen::MatrixXd information = refined.information;
    LeastSquaresNoise noise;
    if (!driver.is_poisson) {
        noise = noise_of(result, information.rows());
        const Eigen::MatrixXd prior = prior_information(*driver.model, driver.solve_settings);
        information = prior + (information - prior) / noise.inflation;
    }
    static_cast<Uncertainty&>(result) = assess(information, result.parameters);
    result.covariance += refined.element_error * refined.element_error.transpose();
    result.sigma = result.sigma.cwiseMax(result.covariance.diagonal().cwiseSqrt());
    widen_sigma(driver, last, best.state, assessing, result);
    static_cast<FittedValues&>(result) =
        fitted_values(driver, last, best.state, result, noise.variance);
    result.converged = best.summary.converged;
    result.message = best.summary.message;
    result.num_elements = last.model->num_elements();

    check_dependence(*driver.model, result);
    add_warnings(driver, last, best.state, result);
    if (!refined.is_settled) {
        result.warnings.push_back(
            "the edges of shadows on the model's elements did not settle: true errors exceed the "
            "reported ones");
    }
    warn_of_ambiguity(driver, candidates, result);
    result.seconds = watch.seconds();
    return result;
}

}  // namespace

FitResult fit_scene(const FitInput& input, const core::Progress& progress) {
    const std::optional<Vec3> way = way_to_origin(input);
    if (!way) return fit_near_origin(input, progress);
    FitResult result = fit_near_origin(moved(input, *way), progress);
    move(result, -*way);
    return result;
}

}  // namespace calib
