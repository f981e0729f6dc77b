// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/background.h"
#include "calib/track/joint_update.h"
#include "calib/track/target_search.h"
#include "calib/track/target_state.h"
#include "calib/track/track_frame.h"
#include "calib/track/track_sensor.h"
#include "calib/track/track_settings.h"

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

// Tracking of hidden targets with histogram cameras. A grid of histograms finds targets that a
// frame shows; a Gaussian around the most likely position and strength, moved on and updated by
// Gauss-Newton steps on the Poisson likelihood, follows each; and a Bernoulli variable says with
// what probability it is there [Ristic2013]. smooth() looks back at a whole track.

namespace calib {

/// What is believed of one target after a frame.
struct TargetEstimate {
    int id = 0;
    double probability = 0.0;  ///< that it is there
    Gaussian predicted;        ///< before the frame
    Gaussian state;            ///< after it
    double predicted_probability = 0.0;
    double log_evidence = 0.0;  ///< see JointUpdate
    bool is_named = false;
};

/// What is believed after a frame.
struct FrameEstimate {
    double time_s = 0.0;
    double dt_s = 0.0;  ///< since the frame before
    bool is_learning = false;
    bool is_used = true;          ///< false: its time does not follow that of the frame before
    double probability = 0.0;     ///< that there is any target
    double log_likelihood = 0.0;  ///< of the frame, over that without any target
    std::vector<TargetEstimate> targets;  ///< also those not named
    std::vector<std::string> warnings;
    std::optional<core::SensorPose> pose;  ///< of the sensor, if it has one
};

/// Follows targets from frame to frame.
class Tracker {
 public:
    /// throws   core::Error for settings that the sensor does not allow
    Tracker(const TrackSettings& settings, const TrackSensor& sensor);

    /// Learns the background from frames without a target.
    void learn_background(const std::vector<TrackFrame>& frames);

    /// Takes the next frame.
    /// throws   core::Error for a frame that is not one of the sensor's, see validate(TrackFrame)
    FrameEstimate step(const TrackFrame& frame);

    /// Expected of background and named targets after the last frame; [zone][bin].
    const std::vector<double>& background() const { return background_.mean(); }
    const std::vector<double>& signal() const { return signal_; }
    const TrackSensor& sensor() const { return sensor_; }

 private:
    void aim(const core::SensorPose& pose);
    std::vector<double> weights_of(const TrackFrame& frame, FrameEstimate& estimate);
    double dispersion_of(const TrackFrame& frame, const std::vector<double>& weights);
    void add_model_error(const std::vector<double>& counts, std::vector<double>& weights) const;
    void warn_once(const std::string& text, FrameEstimate& estimate);
    void predict(double dt_s);
    void update(const FrameCounts& frame, FrameEstimate& estimate);
    void look_for_more(const FrameCounts& frame, double dt_s);
    std::optional<TargetEstimate> find(const FrameCounts& frame) const;
    void report(FrameEstimate& estimate) const;
    bool is_hidden(const core::Vec3& position_m) const;

    TrackSettings settings_;
    TrackSensor sensor_;
    Motion motion_;
    core::SensorPose pose_;
    core::Vec3 search_offset_m_ = core::Vec3::Zero();
    std::unique_ptr<TargetResponse> response_;
    SearchBox box_;
    std::unique_ptr<TargetSearch> search_;
    core::SensorPose search_pose_;
    std::vector<int> first_bins_;  ///< behind the direct return, by zone
    Background background_;
    std::optional<double> last_time_s_;
    std::optional<bool> counts_are_whole_;
    double dispersion_ = 1.0;
    double dispersion_frames_ = 0.0;
    std::vector<TargetEstimate> targets_;
    std::vector<double> signal_;
    int next_id_ = 1;
    std::set<std::string> said_;
};

/// Replaces what was believed of every target after each frame by what is believed of it after all
/// of them: positions, covariances and the probability that it was there.
///
/// frames   as Tracker::step() returned them, in order
/// source   Rauch, Tung and Striebel's smoother [Rauch1965]
void smooth(std::vector<FrameEstimate>& frames, const TrackSettings& settings);

}  // namespace calib
