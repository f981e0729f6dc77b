// SPDX-License-Identifier: MIT
#include "calib/fit/solution.h"

namespace calib {
namespace {

// Standard deviations of a row's columns; kFixed where it is not free.
std::vector<double> sigma_of(const SceneModel& model,
                             const Uncertainty& uncertainty,
                             const Parameter& row,
                             std::size_t item) {
    constexpr std::size_t kMostColumns = 3;  // of a row that is reported although it is fixed
    const ParameterBlock* block = model.find(row, item);
    if (block == nullptr) return std::vector<double>(kMostColumns, kFixed);
    const auto first = uncertainty.sigma.begin() + block->first_column;
    return {first, first + block->columns};
}

FittedObject fitted_object(const FitDriver& driver,
                           const SceneState& state,
                           const Uncertainty& uncertainty,
                           std::size_t b) {
    const ModelBody& body = driver.model->bodies()[b];
    FittedObject object;
    object.name = body.name;
    for (const Parameter* row : parameters()) {
        if (row->owner != Owner::Body) continue;
        const auto sigma = sigma_of(*driver.model, uncertainty, *row, b);
        if (row->report_body != nullptr) {
            row->report_body({body, state.bodies[b]}, sigma, object);
        } else {
            const double number = row->numbers(state, b)[0];
            object.numbers.add(row->key, row->estimate(number, sigma[0], driver.settings));
        }
    }
    return object;
}

FittedPoint fitted_point(const FitDriver& driver,
                         const SceneState& state,
                         const Uncertainty& uncertainty,
                         std::size_t index) {
    FittedPoint point;
    for (const Parameter* row : parameters()) {
        if (row->owner != Owner::Point) continue;
        const auto sigma = sigma_of(*driver.model, uncertainty, *row, index);
        if (row->effect == Effect::Translates) {
            point.position_m = state.points[index].position_m;
            point.position_sigma_m = {sigma[0], sigma[1], sigma[2]};
        } else {
            point.albedo = row->estimate(row->numbers(state, index)[0], sigma[0], driver.settings);
        }
    }
    return point;
}

}  // namespace

double ambient_of(const FitDriver::Stage& stage, const SceneState& state) {
    return added_light(state) + stage.objective->ambient() /
                                    static_cast<double>(stage.model->settings().bins_per_ambient);
}

FittedValues fitted_values(const FitDriver& driver,
                           const FitDriver::Stage& last,
                           const SceneState& state,
                           const Uncertainty& uncertainty,
                           double noise_variance) {
    FittedValues result;
    for (std::size_t b = 0; b < driver.model->bodies().size(); ++b) {
        result.objects.push_back(fitted_object(driver, state, uncertainty, b));
    }
    for (std::size_t i = 0; i < state.points.size(); ++i) {
        result.points.push_back(fitted_point(driver, state, uncertainty, i));
    }
    const FitObjective& objective = *last.objective;
    const auto linear_sigma = objective.linear_sigma(noise_variance, uncertainty.covariance);
    const double bins = last.model->settings().bins_per_ambient;
    for (const Parameter* row : parameters()) {
        if (row->owner != Owner::Scene) continue;
        const double sigma = sigma_of(*driver.model, uncertainty, *row, 0)[0];
        Estimate estimate = row->estimate(row->numbers(state)[0], sigma, driver.settings);
        if (driver.elimination.scale && row->effect == Effect::Multiplies) {
            estimate = {objective.scale(), linear_sigma[0]};
        } else if (driver.elimination.ambient && row->effect == Effect::AddsLight) {
            estimate = {ambient_of(last, state), linear_sigma[1] / bins};
        }
        result.estimates.add(row->key, estimate);
    }
    result.geometry = driver.model->posed(state);
    return result;
}

}  // namespace calib
