// SPDX-License-Identifier: MIT
#pragma once

#include "calib/setup/boards.h"
#include "calib/setup/direct_returns.h"
#include "calib/statistics/uncertainty.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace calib {

/// Something measured by other means.
struct KnownValue {
    double value = 0.0;
    double sigma = 0.0;
};

/// Unit of the galvo's commands: radians have gain 1, volts an unknown one.
enum class CommandUnit { Rad, Volt };

/// What is known of a set-up before its geometry is solved for.
struct SetupObservations {
    std::vector<DirectReturn> returns;            ///< one per wall point
    std::vector<std::array<double, 2>> commands;  ///< likewise
    CommandUnit command_unit = CommandUnit::Rad;
    std::optional<CameraCalibration> camera;
    std::vector<core::Vec2> spots_px;  ///< where the camera sees the laser; empty without a camera
    double spot_sigma_px = 0.1;
    std::optional<KnownValue> wall_distance_m;  ///< along the beam of command (0, 0)
    std::optional<KnownValue> galvo_gain;       ///< both axes [rad per command]
    std::optional<KnownValue> time_zero_m;      ///< path length
};

/// Parameters of a set-up, in this order.
inline const std::array<std::string, 9> kSetupNames{"wall_distance_m",
                                                    "wall_tilt_x_rad",
                                                    "wall_tilt_y_rad",
                                                    "spin_rad",
                                                    "foot_x_m",
                                                    "foot_y_m",
                                                    "time_zero_m",
                                                    "galvo_gain_x",
                                                    "galvo_gain_y"};

/// Where laser, galvo and wall are. The wall is the plane z = 0, its normal +z towards the device.
struct SetupGeometry {
    std::array<double, 9> values{};  ///< see kSetupNames
    std::array<double, 9> sigma{};   ///< 0 for what was held
    core::Vec3 device_m = core::Vec3::Zero();
    std::vector<core::Vec3> points_m;  ///< on the wall
    std::vector<double> point_sigma_m;
    std::vector<double> opl_offset_m;  ///< time zero and both device legs, per point
    std::vector<double> opl_offset_sigma_m;
    double range_rms_m = 0.0;  ///< misfit of the direct returns' path lengths
    Uncertainty uncertainty;
};

/// Solves for wall plane, galvo map, device and time zero in one problem.
///
/// Laser and detector share one device. Command (u, v) sends the beam along (tan gain_x u,
/// tan gain_y v, -1) in the device's frame. Without a camera the foot of beam (0, 0) is the wall's
/// origin and the device does not spin: moving the wall's frame is moving the scene.
///
/// throws   core::Failure naming the parameters that the data cannot tell apart, and what would
/// help
SetupGeometry solve_setup(const SetupObservations& observations);

}  // namespace calib

template <>
struct core::EnumNames<calib::CommandUnit> {
    static constexpr auto value = names_from_zero<calib::CommandUnit>("rad", "volt");
};
