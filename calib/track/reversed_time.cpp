// SPDX-License-Identifier: MIT
#include "calib/track/reversed_time.h"

#include <fmt/core.h>

#include <algorithm>

namespace calib {
namespace {

TrackFrame reversed(TrackFrame frame, int num_bins) {
    for (auto zone = frame.counts.begin(); zone != frame.counts.end(); zone += num_bins) {
        std::reverse(zone, zone + num_bins);
    }
    if (frame.observed) {
        for (core::BinRange& range : *frame.observed) {
            range = {num_bins - range.end, num_bins - range.begin};
        }
    }
    return frame;
}

}  // namespace

std::optional<std::string> reversed_time_warning(const TrackSettings& settings,
                                                 const TrackSensor& sensor,
                                                 const std::vector<TrackFrame>& frames,
                                                 const std::vector<TrackFrame>& background,
                                                 const std::vector<FrameEstimate>& estimates) {
    constexpr std::size_t kMostTried = 100;  // beside those that teach the background
    constexpr double kNotable = 30.0;        // of the logarithm of the likelihood
    constexpr double kNotableFraction = 0.1;
    const std::size_t count =
        std::min(frames.size(), kMostTried + static_cast<std::size_t>(settings.background.frames));
    Tracker tracker(settings, sensor);
    if (!background.empty()) {
        std::vector<TrackFrame> learnt;
        for (const TrackFrame& frame : background) {
            learnt.push_back(reversed(frame, sensor.axis.num_bins));
        }
        tracker.learn_background(learnt);
    }
    double forward = 0.0;
    double backward = 0.0;
    for (std::size_t f = 0; f < count; ++f) {
        forward += estimates[f].log_likelihood;
        backward += tracker.step(reversed(frames[f], sensor.axis.num_bins)).log_likelihood;
    }
    if (backward <= forward + kNotable + kNotableFraction * std::abs(forward)) return std::nullopt;
    return fmt::format(
        "time looks reversed: with their bins in reverse, targets explain {} frames "
        "better (log likelihood {:.0f} instead of {:.0f}); capture.flip_t=true "
        "turns them",
        count,
        backward,
        forward);
}

}  // namespace calib
