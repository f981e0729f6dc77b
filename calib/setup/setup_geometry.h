// SPDX-License-Identifier: MIT
#pragma once

#include "calib/setup/setup_checks.h"
#include "calib/statistics/uncertainty.h"

#include <string>
#include <vector>

namespace calib {

/// Where laser, galvo and wall are. The wall is the plane z = 0, its normal +z towards the device.
struct SetupGeometry {
    SetupValues values{};  ///< see kSetupNames
    SetupValues sigma{};   ///< 0 for what was held
    core::Vec3 device_m = core::Vec3::Zero();
    std::vector<core::Vec3> points_m;  ///< on the wall
    std::vector<double> point_sigma_m;
    std::vector<double> opl_offset_m;  ///< time zero and both device segments, per point
    std::vector<double> opl_offset_sigma_m;
    SetupVerdict verdict;  ///< `sigma` and the like are larger by its sigma_scale
    Uncertainty uncertainty;
};

/// Solves for wall plane, galvo map, device and time zero in one problem.
///
/// Laser and detector share one device. Without a camera the foot of beam (0, 0) is the wall's
/// origin and the device does not spin: moving the wall's frame is moving the scene.
///
/// rule     what is done with points far off
/// throws   core::Failure naming the parameters that the data cannot tell apart, and what would
///          help; or what the observations contradict, see judge_setup()
SetupGeometry solve_setup(const SetupObservations& observations, OutlierRule rule);

}  // namespace calib
