// SPDX-License-Identifier: MIT
#pragma once

#include "calib/setup/boards.h"
#include "calib/setup/direct_returns.h"
#include "calib/setup/setup_geometry.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/settings/json_fwd.h"

#include <optional>
#include <string>
#include <vector>

namespace calib {

/// Quantities measured by other means.
struct KnownSettings {
    std::optional<KnownValue> wall_distance_m;
    std::optional<KnownValue> galvo_gain;
    std::optional<KnownValue> time_zero_m;
};

/// SETUP.json.
struct SetupSettings {
    std::string direct_returns;
    std::vector<std::array<double, 2>> commands;
    CommandUnit command_unit = CommandUnit::Rad;
    std::optional<BoardSettings> boards;
    std::vector<std::array<double, 2>> spots_px;
    double spot_sigma_px = 0.1;
    KnownSettings known;
    ResponseShape response = ResponseShape::Gaussian;
    OutlierRule outliers = OutlierRule::Keep;
};

template <class Visitor>
void for_each_field(KnownValue& s, Visitor&& visit) {
    visit("value", s.value, "what was measured");
    visit("sigma", s.sigma, core::above(0, "its standard deviation"));
}

template <class Visitor>
void for_each_field(KnownSettings& s, Visitor&& visit) {
    visit("wall_distance_m", s.wall_distance_m, "along the beam of command (0, 0) [m]");
    visit("galvo_gain", s.galvo_gain, "beam angle per command [rad]");
    visit("time_zero_m", s.time_zero_m, "path length at true length 0 [m]");
}

template <class Visitor>
void for_each_field(SetupSettings& s, Visitor&& visit) {
    visit("direct_returns", s.direct_returns, "capture with one direct return per wall point");
    visit("commands", s.commands, "[u, v] sent to the galvo for each of them");
    visit("command_unit",
          s.command_unit,
          "of the commands, as angles of the beam; volt leaves the gain open");
    visit("boards", s.boards, "chessboard photographs of a camera that sees the wall");
    visit("spots_px", s.spots_px, "where that camera sees the laser for each command [px]");
    visit("spot_sigma_px", s.spot_sigma_px, core::above(0, "standard deviation of these [px]"));
    visit("known", s.known, "what was measured by other means");
    visit("response", s.response, "shape of the instrument response");
    visit("outliers", s.outliers, "what is done with points far from where the others put them");
}

/// CALIBRATION.json: a set-up with the uncertainty of everything in it.
struct Calibration {
    DirectReturns direct;
    SetupGeometry setup;
    std::optional<CameraCalibration> camera;

    /// What casts doubt on it, a sentence each.
    std::vector<std::string> warnings() const;
};

/// Throws core::Error naming the setting that is out of range.
void validate(const SetupSettings& settings, const std::string& where);

/// Reads SETUP.json; paths become relative to the working folder.
SetupSettings read_setup(const std::string& path, const std::vector<std::string>& overrides);

/// Calibrates a set-up: response, time zero and ambient light from direct returns; wall, galvo and
/// device from their path lengths, the commands and, if there is one, a camera.
///
/// capture   of settings.direct_returns
/// throws    core::Error for inputs that do not fit together; core::Failure when the data cannot
///           determine the set-up, or contradict what is said of them
Calibration calibrate(const SetupSettings& settings, const core::Capture& capture);

core::Json calibration_json(const Calibration& calibration);

/// What applying a calibration needs of its file.
struct AppliedCalibration {
    std::vector<core::Vec3> points_m;
    std::vector<core::Vec3> normals;
    std::vector<double> opl_offset_m;
    core::ResponseSettings response;
};
AppliedCalibration read_calibration(const std::string& path);
/// The same from what calibration_json() gives; `where` is the prefix of messages.
AppliedCalibration applied_calibration(const core::Json& json, const std::string& where);

/// Path length of each pair beside that between wall points: half of both points' offsets.
std::vector<double> pair_offsets(const AppliedCalibration& calibration, const core::WallScan& scan);

/// Puts the calibrated points into a scan of as many.
/// throws   core::Error when the numbers of points differ
void replace_points(const AppliedCalibration& calibration, core::WallScan& scan);

/// A capture between wall points: histograms moved by a part of a bin and more, points replaced.
/// Variance, orders, velocities and frames are left out.
core::Capture apply_calibration(const AppliedCalibration& calibration,
                                const core::Capture& capture);

/// The axis between wall points that light recorded on `axis` can come from.
core::TimeAxis axis_to_render(const AppliedCalibration& calibration, const core::TimeAxis& axis);

/// A capture rendered on axis_to_render() as the calibrated device records it on `axis`: through
/// its response and with its path lengths.
core::Capture record_with(const AppliedCalibration& calibration,
                          const core::Capture& rendered,
                          const core::TimeAxis& axis);

}  // namespace calib
