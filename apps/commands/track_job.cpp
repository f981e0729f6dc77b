// SPDX-License-Identifier: MIT
#include "apps/commands/track_job.h"

#include "apps/arguments.h"
#include "apps/commands/track_frames.h"
#include "apps/commands/track_pictures.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "calib/track/reversed_time.h"
#include "calib/track/track_file.h"
#include "calib/track/tracker.h"
#include "nlos/pictures/picture.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/stopwatch.h"
#include "renderer/core/system/output_file.h"

#include <fmt/core.h>

#include <algorithm>

namespace apps {
namespace {

using calib::FrameEstimate;
using calib::Tracker;
using calib::TrackSensor;
using calib::TrackSettings;

/// A tracker and what it found so far.
class Run {
 public:
    Run(const TrackSettings& settings,
        const TrackSensor& sensor,
        const nlos::CaptureReadSettings& reading)
        : settings_(settings), tracker_(settings, sensor) {
        if (settings.background.file.empty()) return;
        background_ = read_background_frames(settings, tracker_.sensor(), reading).frames;
        tracker_.learn_background(background_);
    }

    const FrameEstimate& step(const calib::TrackFrame& frame) {
        const core::Stopwatch watch;
        estimates_.push_back(tracker_.step(frame));
        summary_.seconds += watch.seconds();
        const FrameEstimate& estimate = estimates_.back();
        ++summary_.frames;
        summary_.warnings.insert(
            summary_.warnings.end(), estimate.warnings.begin(), estimate.warnings.end());
        const bool named = std::ranges::any_of(estimate.targets, &calib::TargetEstimate::is_named);
        if (named && (shown_.counts.empty() || estimate.log_likelihood > best_)) {
            best_ = estimate.log_likelihood;
            shown_ = {frame.time_s, frame.counts, tracker_.background(), tracker_.signal()};
        }
        return estimate;
    }

    /// Warns where frames that were all stepped through seem to run backwards in time.
    void check_time(const std::vector<calib::TrackFrame>& frames) {
        if (const auto text = calib::reversed_time_warning(
                settings_, tracker_.sensor(), frames, background_, estimates_)) {
            summary_.warnings.push_back(*text);
        }
    }

    TrackSummary finish(const TrackRequest& request, const std::vector<std::string>& warnings) {
        if (request.smooth) calib::smooth(estimates_, settings_);
        summary_.warnings.insert(summary_.warnings.begin(), warnings.begin(), warnings.end());
        if (std::ranges::all_of(estimates_, &FrameEstimate::is_learning)) {
            summary_.warnings.push_back(
                fmt::format("all {} frames taught the background, so that none was left to find "
                            "targets in; background.frames is {}",
                            estimates_.size(),
                            settings_.background.frames));
        }
        for (const FrameEstimate& estimate : estimates_) {
            summary_.named +=
                std::ranges::any_of(estimate.targets, &calib::TargetEstimate::is_named) ? 1 : 0;
        }
        if (!request.output.empty()) write_track(request);
        if (!request.csv.empty()) {
            core::write_text_file(request.csv, calib::track_csv(estimates_, settings_));
        }
        if (!request.picture.empty()) {
            nlos::write_panels(
                request.picture, track_panels(estimates_, settings_, tracker_.sensor(), shown_), 2);
        }
        return summary_;
    }

 private:
    void write_track(const TrackRequest& request) const {
        core::Json json = calib::track_json(estimates_, settings_, tracker_.sensor());
        json["smoothed"] = request.smooth;
        json["seconds"] = summary_.seconds;
        json["warnings"] = summary_.warnings;
        json["version"] = version_text();
        json["command"] = command_line();
        core::write_text_file(request.output, core::json_text(json));
    }

    TrackSettings settings_;
    Tracker tracker_;
    std::vector<calib::TrackFrame> background_;
    std::vector<FrameEstimate> estimates_;
    ExplainedFrame shown_;
    double best_ = 0.0;
    TrackSummary summary_;
};

void check_outputs(const TrackRequest& request) {
    require_suffix(request.output, {".json"});
    require_suffix(request.csv, {".csv"});
    nlos::check_picture_suffix(request.picture);
    std::vector<std::string> inputs = request.frames;
    inputs.push_back(request.model);
    core::check_targets({request.output, request.csv, request.picture}, inputs);
}

}  // namespace

TrackSummary track_to_file(const TrackRequest& request) {
    check_outputs(request);
    ProgressBar bar("track");
    const core::Progress progress = bar.progress();
    progress.stage(1, 2, "reading", 0.0, 0.0);
    std::vector<std::string> overrides = request.overrides;
    const auto reading = capture_options(take_capture_overrides(overrides)).capture;
    TrackSettings settings = calib::read_track_settings(request.model, overrides);
    const TrackFrames input = read_track_frames(request.frames, settings, reading);
    Run run(settings, input.sensor, reading);
    const core::Progress tracking = progress.stage(2, 2, "tracking", 0.0, 1.0);
    std::size_t done = 0;
    for (const calib::TrackFrame& frame : input.frames) {
        const StoppableWork stoppable(
            "stopping after this frame, without a file; Ctrl-C again ends at once");
        run.step(frame);
        ++done;
        tracking.update(static_cast<double>(done) / static_cast<double>(input.frames.size()), "");
        if (tracking.should_stop()) throw core::Failure("track", "interrupted");
    }
    run.check_time(input.frames);
    return run.finish(request, input.warnings);
}

TrackSummary track_live(const TrackRequest& request, std::istream& lines) {
    if (request.smooth) {
        throw core::Error("--smooth", "found with live frames", "must come with frames from files");
    }
    check_outputs(request);
    std::vector<std::string> overrides = request.overrides;
    const auto reading = capture_options(take_capture_overrides(overrides)).capture;
    const TrackSettings settings = calib::read_track_settings(request.model, overrides);
    const TrackSensor sensor = given_sensor(settings);
    Run run(settings, sensor, reading);
    FrameLines source(lines, sensor);
    while (const auto frame = source.next()) {
        write_output(calib::frame_json(run.step(*frame), settings).dump() + "\n");
        flush_output();
    }
    return run.finish(request, {});
}

}  // namespace apps
