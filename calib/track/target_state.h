// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/track_settings.h"
#include "renderer/core/types.h"

#include <Eigen/Dense>

#include <vector>

namespace calib {

/// What a frame can tell of a target: its position [m] and the logarithm of its strength. These are
/// the first entries of a state; with constant velocity the velocity [m/s] follows.
inline constexpr int kSeen = 4;
using SeenVector = Eigen::Matrix<double, kSeen, 1>;
using SeenMatrix = Eigen::Matrix<double, kSeen, kSeen>;

/// A normal distribution of states.
struct Gaussian {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;

    core::Vec3 position_m() const { return mean.head<3>(); }
    core::Mat3 position_covariance() const { return covariance.topLeftCorner<3, 3>(); }
    double strength() const;
};

/// How states move on.
class Motion {
 public:
    explicit Motion(const MotionSettings& settings) : settings_(settings) {}

    Eigen::MatrixXd transition(double dt_s) const;
    Eigen::MatrixXd noise(double dt_s) const;
    Gaussian predict(const Gaussian& now, double dt_s) const;

    /// A state of which only what a frame tells is known yet.
    Gaussian start(const SeenVector& mean, const SeenMatrix& covariance) const;

 private:
    bool has_velocity() const { return settings_.kind == MotionKind::ConstantVelocity; }
    int size() const { return has_velocity() ? kSeen + 3 : kSeen; }

    MotionSettings settings_;
};

/// A prior distribution after its seen part became normal with this mean and covariance: what was
/// correlated with it follows.
Gaussian condition(const Gaussian& prior, const SeenVector& mean, const SeenMatrix& covariance);

}  // namespace calib
