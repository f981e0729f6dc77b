// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/track_sensor.h"
#include "calib/track/track_settings.h"
#include "calib/track/tracker.h"
#include "nlos/layouts/capture_settings.h"

#include <istream>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Frames of a capture, and what counted them.
struct TrackFrames {
    calib::TrackSensor sensor;
    std::vector<calib::TrackFrame> frames;
    std::vector<std::string> warnings;
};

/// Reads frames: a sequence capture, a folder or list of files that are frames. Where their names
/// end in numbers, a number left out is a frame missing.
///
/// settings   which also get the poses that the capture gives, when they give none
/// throws     core::Error when the frames do not say what counted them and the settings do not
TrackFrames read_track_frames(const std::vector<std::string>& paths,
                              calib::TrackSettings& settings,
                              const nlos::CaptureReadSettings& reading);

/// Reads the frames that settings.background.file names.
/// throws   core::Error when they do not fit the frames of the sensor
TrackFrames read_background_frames(const calib::TrackSettings& settings,
                                   const calib::TrackSensor& sensor,
                                   const nlos::CaptureReadSettings& reading);

/// The sensor that settings name, for frames that come without any word of it.
/// throws   core::Error when they name none
calib::TrackSensor given_sensor(const calib::TrackSettings& settings);

/// Reads the next frame from lines of JSON: `t` [s], without it a frame's time after the last;
/// `histograms`, a list of bins per zone, or null for a missing frame; on request `pose`.
class FrameLines {
 public:
    FrameLines(std::istream& lines, const calib::TrackSensor& sensor);

    /// Nothing at the end. Throws core::Error naming the line.
    std::optional<calib::TrackFrame> next();

 private:
    std::istream& lines_;
    std::size_t num_zones_;
    std::size_t num_bins_;
    double frame_s_;
    std::size_t line_ = 0;
    std::optional<double> last_time_s_;
};

}  // namespace apps
