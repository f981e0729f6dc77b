// SPDX-License-Identifier: MIT
#pragma once

#include "calib/setup/setup_observations.h"

namespace calib {

// Residuals of a set-up in standard deviations, for numbers or automatic derivatives.

/// A point's path length, modelled minus measured.
struct LengthCost {
    static constexpr int kResiduals = 1;
    std::array<double, 2> command;
    double opl_m;
    double sigma_m;
    template <class T>
    bool operator()(const T* p, T* residual) const {
        T length;
        spot_of(p, command, length);
        residual[0] = (p[kZero] + 2.0 * length - opl_m) / sigma_m;
        return true;
    }
};

/// Where the camera saw the point.
struct SpotCost {
    static constexpr int kResiduals = 2;
    std::array<double, 2> command;
    core::Vec2 pixel;
    double sigma_px;
    const CameraCalibration* camera;
    template <class T>
    bool operator()(const T* p, T* residual) const {
        T length;
        const Eigen::Matrix<T, 3, 1> wall = spot_of(p, command, length);
        const Eigen::Matrix<T, 2, 1> seen = camera->project<T>(wall);
        residual[0] = (seen[0] - pixel.x()) / sigma_px;
        residual[1] = (seen[1] - pixel.y()) / sigma_px;
        return true;
    }
};

/// A parameter that is known by other means.
struct KnownCost {
    static constexpr int kResiduals = 1;
    int parameter;
    KnownValue known;
    template <class T>
    bool operator()(const T* p, T* residual) const {
        residual[0] = (p[parameter] - known.value) / known.sigma;
        return true;
    }
};

}  // namespace calib
