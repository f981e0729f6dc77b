// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/scene_model.h"
#include "renderer/core/capture/capture.h"

#include <array>
#include <vector>

namespace calib {

/// A wall point after bow and scale, and how it moves with them.
struct MovedWallPoint {
    core::Vec3 position;
    core::Vec3 normal;
    std::array<core::Vec3, 2> position_gradient;  ///< by bow and by log scale
    std::array<core::Vec3, 2> normal_gradient;
};

/// The wall as a paraboloid: points grow by `scale` about their centre and rise along the mean
/// normal by bow (1 - |p|^2 / R^2), R the distance of the farthest point.
class WallMotion {
 public:
    explicit WallMotion(const core::WallScan& scan);

    std::vector<MovedWallPoint> moved(const core::WallPoints& points,
                                      const SceneState& state) const;
    core::WallPoints moved_points(const core::WallPoints& points, const SceneState& state) const;

 private:
    core::Vec3 center_ = core::Vec3::Zero();
    core::Vec3 normal_ = core::Vec3::Zero();
    double squared_radius_m2_ = 0.0;
};

}  // namespace calib
