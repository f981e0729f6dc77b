// SPDX-License-Identifier: MIT
#include "calib/fit/solution.h"

#include <cmath>

namespace calib {
namespace {

using core::Vec3;

// Standard deviations by parameter; kFixed for those that were not free.
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

void store_objects(const FitDriver& driver,
                   const SceneState& state,
                   const Sigmas& sigmas,
                   FittedValues& result) {
    const SceneModel& model = *driver.model;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
        const ModelBody& body = model.bodies()[b];
        const BodyState& s = state.bodies[b];
        FittedObject& object = result.objects.emplace_back();
        object.name = body.name;
        object.position_m = s.position_m;
        object.rotation = (s.rotation * Eigen::Quaterniond(body.turn)).normalized();
        if (object.rotation.w() < 0.0) object.rotation.coeffs() *= -1.0;
        object.size = std::exp(s.log_size);
        object.albedo = std::exp(s.log_albedo);
        object.heights_m = s.heights_m;
        object.position_sigma_m = sigmas.vector(ParameterKind::Translation, b);
        object.rotation_sigma_deg =
            core::kDegreesPerRadian * sigmas.vector(ParameterKind::Rotation, b);
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

}  // namespace

double ambient_of(const FitDriver::Stage& stage, const SceneState& state) {
    return state.has_ambient ? std::exp(state.log_ambient)
                             : stage.objective->ambient() /
                                   static_cast<double>(stage.model->settings().bins_per_ambient);
}

FittedValues fitted_values(const FitDriver& driver,
                           const FitDriver::Stage& last,
                           const SceneState& state,
                           const Uncertainty& uncertainty,
                           double noise_variance) {
    const Sigmas sigmas(*driver.model, uncertainty);
    const auto estimate = [&](double value, ParameterKind kind) {
        return Estimate{value, sigmas.at(kind)};
    };
    // Of a parameter that is a logarithm.
    const auto positive = [&](double value, ParameterKind kind) {
        return Estimate{value, value * sigmas.at(kind)};
    };
    FittedValues result;
    store_objects(driver, state, sigmas, result);
    result.scale = positive(std::exp(state.log_scale), ParameterKind::Scale);
    result.time_zero_m = estimate(state.time_zero_m, ParameterKind::TimeZero);
    result.ambient = positive(ambient_of(last, state), ParameterKind::Ambient);
    const FitObjective& objective = *last.objective;
    const auto linear_sigma = objective.linear_sigma(noise_variance, uncertainty.covariance);
    if (driver.elimination.scale) result.scale = {objective.scale(), linear_sigma[0]};
    if (driver.elimination.ambient) {
        result.ambient.sigma =
            linear_sigma[1] / static_cast<double>(last.model->settings().bins_per_ambient);
    }
    result.response_fwhm_ps =
        positive(driver.settings.response.jitter_fwhm_ps * std::exp(state.log_width),
                 ParameterKind::ResponseWidth);
    result.wall_bow_m = estimate(state.bow_m, ParameterKind::WallBow);
    result.wall_scale = positive(std::exp(state.log_wall_scale), ParameterKind::WallScale);
    result.geometry = driver.model->posed(state);
    return result;
}

}  // namespace calib
