// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/scene_state.h"
#include "renderer/core/capture/capture.h"

#include <vector>

namespace calib {

/// How a wall point moves with one parameter.
struct WallGradient {
    core::Vec3 position;
    core::Vec3 normal;
};

/// A wall point where a state puts it.
struct MovedWallPoint {
    core::Vec3 position;
    core::Vec3 normal;
    std::vector<WallGradient> gradients;  ///< by the rows that move the wall, in their order
};

/// Where a point stands on the wall before it is moved.
struct WallPosition {
    core::Vec3 from_center_m;
    core::Vec3 start_normal;
    core::Vec3 wall_normal;          ///< mean of all points'
    double squared_radius_m2 = 0.0;  ///< of the farthest point from the centre
};

/// The wall as its parameters bend it: each moves all points, and tilts their normals, in turn.
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
