// SPDX-License-Identifier: MIT
#include "calib/fit/solution.h"
#include "calib/model/state_vector.h"
#include "renderer/core/random.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

constexpr int kRefits = 40;
constexpr int kRefitIterations = 20;
constexpr std::uint64_t kRefitSeed = 0x7265666974;

// Inversion of the distribution function: means are far below 1 where there are few photons.
double draw_count(core::Rng& rng, double mean) {
    double probability = std::exp(-mean);
    double rest = rng.uniform() - probability;
    double count = 0.0;
    while (rest > 0.0 && probability > 0.0) {
        count += 1.0;
        probability *= mean / count;
        rest -= probability;
    }
    return count;
}

}  // namespace

Eigen::VectorXd bootstrap_scatter(const FitDriver& driver,
                                  const FitDriver::Stage& stage,
                                  const SceneState& state,
                                  const core::Progress& progress) {
    stage.model->update(state, renderer::Gradients::Without);
    std::vector<double> means;
    PairModel pair;
    for (std::size_t i = 0; i < stage.model->scan().num_pairs(); ++i) {
        stage.model->evaluate(i, pair);
        means.insert(means.end(), pair.mean.begin(), pair.mean.end());
    }
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(driver.model->num_columns());
    const auto others = driver.turned(state);
    SolveSettings settings = driver.solve_settings;
    settings.max_iterations = kRefitIterations;
    for (std::uint64_t refit = 0; refit < kRefits; ++refit) {
        progress.update(static_cast<double>(refit) / kRefits, "refits to simulated data");
        core::Rng rng(kRefitSeed, refit, 0);
        FitData data = *stage.data;
        for (std::size_t i = 0; i < means.size(); ++i) {
            data.values[i] = draw_count(rng, std::max(means[i], data.min_mean));
        }
        FitObjective objective(
            *stage.model, data, true, Elimination{}, driver.model->num_columns());
        SceneState moved = state;
        double least = solve_stage(*driver.model, objective, settings, moved).cost;
        for (const auto& [name, turned] : others) {
            SceneState other = turned;
            const double cost = solve_stage(*driver.model, objective, settings, other).cost;
            if (cost < least) moved = other;
            least = std::min(least, cost);
        }
        squares += difference(*driver.model, state, moved).cwiseAbs2();
    }
    return (squares / kRefits).cwiseSqrt();
}

}  // namespace calib
