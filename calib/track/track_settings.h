// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/relay_wall.h"
#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/settings/settings.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace calib {

/// How a hidden target sends light back: to the wall point it came from, or everywhere.
enum class TargetKind { Retroreflective, Diffuse };

/// How a target moves: its position, or its velocity, wanders.
enum class MotionKind { RandomWalk, ConstantVelocity };

/// What is known of the light that no target sends: the mean of frames, or one level per zone, for
/// frames whose background was subtracted already.
enum class BackgroundKind { Learn, Flat };

/// What moves and is to be found: the hidden target, or the sensor before a target that stands.
enum class TrackUnknown { Target, SensorPose };

struct TargetSettings {
    TargetKind kind = TargetKind::Retroreflective;
    double radius_m = 0.0;
    std::optional<core::Vec3> position_m;

    /// Whether light goes back to the wall point that it came from, instead of everywhere.
    bool returns_light() const { return kind == TargetKind::Retroreflective; }
};

struct MotionSettings {
    MotionKind kind = MotionKind::ConstantVelocity;
    double diffusion = 0.5;
    double acceleration = 1.0;
    double speed_m_per_s = 1.0;
    double strength_rate = 0.5;
};

struct BackgroundSettings {
    BackgroundKind kind = BackgroundKind::Learn;
    int frames = 20;
    int memory_frames = 300;
    std::string file;
};

struct NoiseSettings {
    std::optional<double> dispersion;
    std::optional<double> saturation_counts;
    double model_error = 0.1;
    double systematic_m = 0.002;
};

struct ExistenceSettings {
    double birth_per_s = 0.02;
    double lifetime_s = 20.0;
    double name_at = 0.5;
};

struct SearchSettings {
    std::optional<std::array<double, 2>> x_range_m;
    std::optional<std::array<double, 2>> y_range_m;
    std::array<double, 2> z_range_m{0.2, 2.5};
    double cell_m = 0.12;
};

/// Where a sensor is and looks, as far as it is given.
struct PoseSettings {
    std::optional<core::Vec3> position_m;
    std::optional<core::Vec3> forward;
    std::optional<core::Vec3> up;

    bool is_given() const { return position_m || forward || up; }
    /// Takes from another pose what is not reported.
    void complete(const core::SensorPose& other);
    /// The pose, completed by one that looks at the wall z = 0 from a metre before its centre.
    core::SensorPose whole() const;
};

/// All that MODEL.json of `nlos track` says.
struct TrackSettings {
    std::string sensor;
    PoseSettings pose;
    std::vector<core::SensorPose> poses;
    std::optional<core::RelayWall> wall;
    int subsamples = 3;
    std::optional<double> response_fwhm_ps;
    double time_zero_m = 0.0;
    std::optional<double> frame_s;
    TargetSettings target;
    MotionSettings motion;
    BackgroundSettings background;
    NoiseSettings noise;
    ExistenceSettings existence;
    SearchSettings search;
    int max_targets = 1;
    TrackUnknown free = TrackUnknown::Target;

    /// Whether the sensor moves before a target that stands, instead of the target.
    bool moves_sensor() const { return free == TrackUnknown::SensorPose; }
};

template <class Visitor>
void for_each_field(TargetSettings& s, Visitor&& visit) {
    visit("kind", s.kind, "how the target sends light back");
    visit("radius_m",
          s.radius_m,
          core::Ranged{"of a small body, in which any part may send the light; 0: a point [m]",
                       {0, true, 10, true}});
    visit("position_m", s.position_m, "where it stands, when the sensor's pose is free [m]");
}

template <class Visitor>
void for_each_field(MotionSettings& s, Visitor&& visit) {
    visit("kind", s.kind, "what wanders: the position or the velocity");
    visit("diffusion",
          s.diffusion,
          core::above(0, "random walk: spread after a second along each axis [m/s^0.5]"));
    visit("acceleration",
          s.acceleration,
          core::above(0, "constant velocity: its spread after a second along each axis [m/s^1.5]"));
    visit("speed_m_per_s",
          s.speed_m_per_s,
          core::above(0, "spread of the first velocity along each axis [m/s]"));
    visit("strength_rate",
          s.strength_rate,
          core::at_least(
              0, "spread after a second of the logarithm of the target's strength [1/s^0.5]"));
}

template <class Visitor>
void for_each_field(BackgroundSettings& s, Visitor&& visit) {
    visit("kind",
          s.kind,
          "the mean of frames, or one level per zone where it was subtracted already");
    visit("frames",
          s.frames,
          core::at_least(1, "first frames that teach the background and name no target"));
    visit("memory_frames",
          s.memory_frames,
          core::at_least(1, "frames over which the background follows changes"));
    visit("file", s.file, "capture of frames without a target to learn from instead");
}

template <class Visitor>
void for_each_field(NoiseSettings& s, Visitor&& visit) {
    visit("dispersion",
          s.dispersion,
          core::above(0,
                      "variance of a bin over its mean; null: 1 for whole counts, else as bins "
                      "beside each other differ"));
    visit("saturation_counts",
          s.saturation_counts,
          core::above(0, "counts at which a bin is full and says nothing; null: never"));
    visit("model_error",
          s.model_error,
          core::at_least(0,
                         "relative standard deviation of what a target adds to a bin from what the "
                         "model says"));
    visit("systematic_m",
          s.systematic_m,
          core::at_least(0,
                         "error along each axis that no number of frames averages away, beside "
                         "those of counting in reported covariances [m]"));
}

template <class Visitor>
void for_each_field(ExistenceSettings& s, Visitor&& visit) {
    visit("birth_per_s", s.birth_per_s, core::above(0, "targets that appear per second [1/s]"));
    visit("lifetime_s", s.lifetime_s, core::above(0, "mean time that a target stays [s]"));
    visit("name_at",
          s.name_at,
          core::strictly_between(0, 1, "probability from which on a target is named"));
}

template <class Visitor>
void for_each_field(SearchSettings& s, Visitor&& visit) {
    visit("x_range_m",
          s.x_range_m,
          core::Ranged{
              "where targets may appear along wall x; null: up to 1 m beyond what the sensor sees "
              "[m]",
              {}});
    visit("y_range_m",
          s.y_range_m,
          core::Ranged{"the same along wall y [m]; null: up to 0.75 m beyond", {}});
    visit("z_range_m", s.z_range_m, core::above(0, "the same in depth from the wall [m]"));
    visit("cell_m", s.cell_m, core::above(0, "pitch of the grid on which targets are found [m]"));
}

template <class Visitor>
void for_each_field(PoseSettings& s, Visitor&& visit) {
    visit("position_m",
          s.position_m,
          "receiving lens, world; null: as the frames say, else a metre before the wall z = 0 [m]");
    visit("forward", s.forward, "direction of view; null: as the frames say, else along -z");
    visit("up", s.up, "upwards, up to its part along the view; null: as the frames say, else y");
}

template <class Visitor>
void for_each_field(TrackSettings& s, Visitor&& visit) {
    visit("sensor",
          s.sensor,
          "name or JSON file of a sensor; empty: what the frames say, or their wall points");
    visit("pose", s.pose, "where the sensor is and looks");
    visit("poses", s.poses, "its poses frame by frame, in place of pose");
    visit("wall", s.wall, "the wall; null: the plane through the frames' wall points, or z = 0");
    visit(
        "subsamples", s.subsamples, core::Ranged{"points per zone and axis", {1, true, 64, true}});
    visit("response_fwhm_ps",
          s.response_fwhm_ps,
          core::above(0, "width of pulse and jitter; null: the sensor's, else 1000 [ps]"));
    visit("time_zero_m", s.time_zero_m, core::Ranged{"true path length = axis - this [m]", {}});
    visit("frame_s",
          s.frame_s,
          core::above(0,
                      "time from frame to frame; null: the frames' or the sensor's, else 0.1 [s]"));
    visit("target", s.target, "what is tracked");
    visit("motion", s.motion, "how it moves");
    visit("background", s.background, "light that no target sends");
    visit("noise", s.noise, "how counts scatter");
    visit("existence", s.existence, "how targets come and go");
    visit("search", s.search, "where targets may be");
    visit("max_targets", s.max_targets, core::Ranged{"targets at a time", {1, true, 8, true}});
    visit("free", s.free, "what moves: the target, or the sensor before a target that stands");
}

/// Throws core::Error naming the first setting that is out of range.
void validate(const TrackSettings& settings, const std::string& where);

/// Reads MODEL.json and then `key.path=value` texts.
/// throws   core::Error naming file, key and what is allowed
TrackSettings read_track_settings(const std::string& path,
                                  const std::vector<std::string>& overrides);

}  // namespace calib

template <>
struct core::EnumNames<calib::TargetKind> {
    static constexpr auto value = names_from_zero<calib::TargetKind>("retroreflective", "diffuse");
};
template <>
struct core::EnumNames<calib::MotionKind> {
    static constexpr auto value =
        names_from_zero<calib::MotionKind>("random_walk", "constant_velocity");
};
template <>
struct core::EnumNames<calib::BackgroundKind> {
    static constexpr auto value = names_from_zero<calib::BackgroundKind>("learn", "flat");
};
template <>
struct core::EnumNames<calib::TrackUnknown> {
    static constexpr auto value = names_from_zero<calib::TrackUnknown>("target", "sensor_pose");
};
