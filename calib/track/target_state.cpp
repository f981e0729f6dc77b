// SPDX-License-Identifier: MIT
#include "calib/track/target_state.h"

#include <cmath>

namespace calib {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double Gaussian::strength() const {
    return std::exp(mean[kSeen - 1]);
}

MatrixXd Motion::transition(double dt_s) const {
    MatrixXd f = MatrixXd::Identity(size(), size());
    if (has_velocity()) f.block<3, 3>(0, kSeen) = dt_s * core::Mat3::Identity();
    return f;
}

// Of a velocity that wanders with white acceleration, or of a position that wanders.
MatrixXd Motion::noise(double dt_s) const {
    MatrixXd q = MatrixXd::Zero(size(), size());
    q(kSeen - 1, kSeen - 1) = settings_.strength_rate * settings_.strength_rate * dt_s;
    const core::Mat3 unit = core::Mat3::Identity();
    if (!has_velocity()) {
        q.topLeftCorner<3, 3>() = settings_.diffusion * settings_.diffusion * dt_s * unit;
        return q;
    }
    const double density = settings_.acceleration * settings_.acceleration;
    q.topLeftCorner<3, 3>() = density * dt_s * dt_s * dt_s / 3.0 * unit;
    q.block<3, 3>(0, kSeen) = density * dt_s * dt_s / 2.0 * unit;
    q.block<3, 3>(kSeen, 0) = q.block<3, 3>(0, kSeen);
    q.block<3, 3>(kSeen, kSeen) = density * dt_s * unit;
    return q;
}

Gaussian Motion::predict(const Gaussian& now, double dt_s) const {
    const MatrixXd f = transition(dt_s);
    return {f * now.mean, f * now.covariance * f.transpose() + noise(dt_s)};
}

Gaussian Motion::start(const SeenVector& mean, const SeenMatrix& covariance) const {
    Gaussian state{VectorXd::Zero(size()), MatrixXd::Zero(size(), size())};
    state.mean.head<kSeen>() = mean;
    state.covariance.topLeftCorner<kSeen, kSeen>() = covariance;
    if (has_velocity()) {
        const double speed = settings_.speed_m_per_s;
        state.covariance.block<3, 3>(kSeen, kSeen) = speed * speed * core::Mat3::Identity();
    }
    return state;
}

Gaussian condition(const Gaussian& prior, const SeenVector& mean, const SeenMatrix& covariance) {
    const SeenMatrix before = prior.covariance.topLeftCorner<kSeen, kSeen>();
    const MatrixXd gain = before.ldlt().solve(prior.covariance.topRows<kSeen>()).transpose();
    Gaussian after = prior;
    after.mean += gain * (mean - prior.mean.head<kSeen>());
    after.covariance -= gain * (before - covariance) * gain.transpose();
    after.covariance = (0.5 * (after.covariance + after.covariance.transpose())).eval();
    return after;
}

}  // namespace calib
