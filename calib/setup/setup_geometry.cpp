// SPDX-License-Identifier: MIT
#include "calib/setup/setup_geometry.h"

#include "renderer/core/error.h"

#include <ceres/ceres.h>
#include <fmt/core.h>

#include <cmath>

namespace calib {
namespace {

// A calibration whose distance or gain is known no better than this is no calibration.
constexpr double kWorstRelativeDistance = 0.01;
constexpr double kWorstRelativeGain = 0.01;
constexpr double kWorstTilt_rad = 0.05;

void refuse_if_singular(const SetupObservations& o, const SetupGeometry& setup) {
    const double distance = setup.values[kDistance];
    const bool is_loose =
        setup.sigma[kDistance] > kWorstRelativeDistance * distance ||
        setup.sigma[kGainX] > kWorstRelativeGain * std::abs(setup.values[kGainX]) ||
        setup.sigma[kGainY] > kWorstRelativeGain * std::abs(setup.values[kGainY]) ||
        setup.sigma[kTiltX] > kWorstTilt_rad || setup.sigma[kTiltY] > kWorstTilt_rad;
    if (!is_loose) return;
    std::string help = "a view of the wall tilted by some 30 degrees";
    if (!o.wall_distance_m) help += ", known.wall_distance_m";
    if (!has_known_gain(o)) help += ", known.galvo_gain";
    if (!o.time_zero_m) help += ", known.time_zero_m";
    if (!o.camera) help += ", a camera with boards";
    const std::string which = setup.uncertainty.unidentifiable.empty()
                                  ? "its parameters"
                                  : setup.uncertainty.unidentifiable.front();
    throw core::Failure(
        "calibrate",
        fmt::format("singular: the data hardly determine {} (condition number {:.1e}, wall "
                    "distance known to {:.1f} mm); any of these would help: {}",
                    which,
                    setup.uncertainty.condition_number,
                    1e3 * setup.sigma[kDistance],
                    help));
}

// Standard deviation of a function of the free parameters.
template <class Function>
double propagated(const Function& function,
                  const SetupGeometry& setup,
                  const std::vector<int>& free) {
    using Jet = ceres::Jet<double, kNumSetupParameters>;
    std::array<Jet, kNumSetupParameters> p;
    for (int i = 0; i < kNumSetupParameters; ++i) {
        p[static_cast<std::size_t>(i)] = Jet(setup.values[static_cast<std::size_t>(i)], i);
    }
    const Jet value = function(p.data());
    Eigen::VectorXd gradient(static_cast<Eigen::Index>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i) {
        gradient[static_cast<Eigen::Index>(i)] = value.v[free[i]];
    }
    return std::sqrt(gradient.dot(setup.uncertainty.covariance * gradient));
}

void store_points(const SetupObservations& o, SetupGeometry& setup) {
    const std::vector<int>& free = setup.verdict.fit.free;
    setup.device_m = device_of(setup.values.data());
    for (std::size_t i = 0; i < o.commands.size(); ++i) {
        double length = 0.0;
        setup.points_m.push_back(spot_of(setup.values.data(), o.commands[i], length));
        setup.points_m.back().z() = 0.0;
        setup.opl_offset_m.push_back(setup.values[kZero] + 2.0 * length);
        double variance = 0.0;
        for (int axis = 0; axis < 2; ++axis) {
            const double sigma = propagated(
                [&](const auto* p) {
                    std::decay_t<decltype(p[0])> unused;
                    return spot_of(p, o.commands[i], unused)[axis];
                },
                setup,
                free);
            variance += sigma * sigma;
        }
        setup.point_sigma_m.push_back(std::sqrt(variance));
        setup.opl_offset_sigma_m.push_back(propagated(
            [&](const auto* p) {
                std::decay_t<decltype(p[0])> beam;
                spot_of(p, o.commands[i], beam);
                return p[kZero] + 2.0 * beam;
            },
            setup,
            free));
    }
}

// What counting leaves open; the misfit's fraction comes on top.
void store_uncertainty(SetupGeometry& setup) {
    const SetupFit& fit = setup.verdict.fit;
    std::vector<std::string> names;
    for (const int i : fit.free) names.push_back(kSetupNames[static_cast<std::size_t>(i)]);
    setup.uncertainty = assess(fit.information, names);
    for (std::size_t i = 0; i < fit.free.size(); ++i) {
        setup.sigma[static_cast<std::size_t>(fit.free[i])] =
            setup.uncertainty.sigma[static_cast<Eigen::Index>(i)];
    }
}

void grow_errors(double scale, SetupGeometry& setup) {
    for (double& sigma : setup.sigma) sigma *= scale;
    setup.uncertainty.sigma *= scale;
    setup.uncertainty.covariance *= scale * scale;
}

void refuse_bound(const SetupFit& fit) {
    for (const int i : fit.free) {
        const auto item = static_cast<std::size_t>(i);
        if (fit.at_bound != kSetupNames[item]) continue;
        throw core::Failure("calibrate",
                            fmt::format("{} ended at its bound, {:.4g}: `commands`, command_unit "
                                        "or what is known do not belong to these direct returns",
                                        fit.at_bound,
                                        fit.values[item]));
    }
}

}  // namespace

SetupGeometry solve_setup(const SetupObservations& o, OutlierRule rule) {
    SetupGeometry setup;
    setup.verdict = judge_setup(o, rule);
    setup.values = setup.verdict.fit.values;
    store_uncertainty(setup);
    refuse_if_singular(o, setup);
    refuse_bound(setup.verdict.fit);
    grow_errors(setup.verdict.sigma_scale, setup);
    store_points(o, setup);
    return setup;
}

}  // namespace calib
