// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace calib {

/// Numbers by the name of their parameter (parameter.h), as a solver sees them: those that are
/// positive by nature are logarithms.
using Numbers = std::map<std::string, double, std::less<>>;

/// Where a fit stands with one body, relative to the model's start.
struct BodyState {
    core::Vec3 position_m = core::Vec3::Zero();                    ///< of the node's origin, world
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< about that origin
    double log_size = 0.0;
    std::vector<double> heights_m;  ///< along the start's vertex normals; empty unless free
    Numbers numbers;                ///< of all other parameters
};

/// A small isotropic scatterer.
struct PointState {
    core::Vec3 position_m = core::Vec3::Zero();
    Numbers numbers;
};

/// Everything a fit can change.
struct SceneState {
    std::vector<BodyState> bodies;
    std::vector<PointState> points;
    Numbers numbers;  ///< of wall, device and scene as a whole
};

}  // namespace calib
