// SPDX-License-Identifier: MIT
#pragma once

#include "calib/setup/boards.h"
#include "calib/setup/direct_returns.h"
#include "calib/setup/setup_model.h"

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

/// Unit of the galvo's commands. Volts have a gain that is to be found.
enum class CommandUnit { Rad, Deg, Mrad, Volt };

/// What is known of a set-up before its geometry is solved for.
struct SetupObservations {
    std::vector<DirectReturn> returns;            ///< one per wall point
    core::TimeAxis axis;                          ///< on which they were counted
    std::vector<std::array<double, 2>> commands;  ///< one per wall point
    CommandUnit command_unit = CommandUnit::Rad;
    std::optional<CameraCalibration> camera;
    std::vector<core::Vec2> spots_px;  ///< where the camera sees the laser; empty without a camera
    double spot_sigma_px = 0.1;
    std::optional<KnownValue> wall_distance_m;  ///< along the beam of command (0, 0)
    std::optional<KnownValue> galvo_gain;       ///< both axes [rad per command]
    std::optional<KnownValue> time_zero_m;      ///< path length
    std::vector<bool> left_out;                 ///< points that do not count; empty: all do

    bool counts(std::size_t point) const { return left_out.empty() || !left_out[point]; }
};

/// A quantity that may be known: its key in SETUP.json and the parameters that it is about.
struct KnownKey {
    std::string name;
    std::optional<KnownValue> SetupObservations::*value;
    std::vector<SetupParameter> parameters;
};
inline const std::array<KnownKey, 3> kKnownKeys{
    KnownKey{"known.wall_distance_m", &SetupObservations::wall_distance_m, {kDistance}},
    KnownKey{"known.galvo_gain", &SetupObservations::galvo_gain, {kGainX, kGainY}},
    KnownKey{"known.time_zero_m", &SetupObservations::time_zero_m, {kZero}}};

/// Angle per command of a unit [rad]; nothing where it is to be found.
inline std::optional<double> angle_of(CommandUnit unit) {
    constexpr std::array<double, 3> kAngles_rad{1.0, core::kPi / 180.0, 1e-3};
    const auto index = static_cast<std::size_t>(unit);
    return index < kAngles_rad.size() ? std::optional(kAngles_rad[index]) : std::nullopt;
}

/// Whether the angle per command is known without being measured by direct returns.
inline bool has_known_gain(const SetupObservations& o) {
    return o.galvo_gain || angle_of(o.command_unit);
}

}  // namespace calib

template <>
struct core::EnumNames<calib::CommandUnit> {
    static constexpr auto value = names_from_zero<calib::CommandUnit>("rad", "deg", "mrad", "volt");
};
