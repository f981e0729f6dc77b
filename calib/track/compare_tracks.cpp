// SPDX-License-Identifier: MIT
#include "calib/track/compare_tracks.h"

#include "renderer/core/statistics.h"

#include <Eigen/Dense>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace calib {
namespace {

// Half the usual time between frames.
double tolerance_s(const std::vector<TrackedFrame>& frames) {
    std::vector<double> intervals;
    for (std::size_t i = 1; i < frames.size(); ++i) {
        intervals.push_back(std::abs(frames[i].time_s - frames[i - 1].time_s));
    }
    return intervals.empty() ? std::numeric_limits<double>::infinity()
                             : 0.5 * core::upper_median(intervals);
}

std::optional<double> fraction(std::size_t part, std::size_t all) {
    if (all == 0) return std::nullopt;
    return static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace

void TrackScorer::add(const std::vector<TrackedFrame>& track,
                      const std::vector<TrackedFrame>& truth,
                      const std::string& where) {
    const double tolerance = tolerance_s(truth);
    bool any = false;
    std::optional<double> appeared_s;  // of a target that is still to be named
    std::size_t present = 0;
    for (const TrackedFrame& found : track) {
        const auto nearest =
            std::min_element(truth.begin(), truth.end(), [&](const auto& a, const auto& b) {
                return std::abs(a.time_s - found.time_s) < std::abs(b.time_s - found.time_s);
            });
        if (nearest == truth.end() || std::abs(nearest->time_s - found.time_s) > tolerance)
            continue;
        any = true;
        if (found.is_learning) continue;
        add_frame(found, *nearest);
        if (nearest->targets.size() > present) appeared_s = nearest->time_s;
        present = nearest->targets.size();
        if (present == 0) appeared_s.reset();
        if (appeared_s && found.targets.size() >= present) {
            latencies_s_.push_back(std::max(0.0, found.time_s - *appeared_s));
            appeared_s.reset();
        }
    }
    if (!any) {
        throw core::Error(
            where,
            fmt::format("no frame of {} has the time of one of {}", track.size(), truth.size()),
            "must be of the same times [s]");
    }
}

void TrackScorer::add_frame(const TrackedFrame& found, const TrackedFrame& truth) {
    ++frames_;
    alarmed_ += found.targets.size() > truth.targets.size() ? 1 : 0;
    there_ += truth.targets.size();
    std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
    for (std::size_t f = 0; f < found.targets.size(); ++f) {
        for (std::size_t t = 0; t < truth.targets.size(); ++t) {
            pairs.emplace_back(
                (found.targets[f].position_m - truth.targets[t].position_m).norm(), f, t);
        }
    }
    std::sort(pairs.begin(), pairs.end());
    std::vector<bool> used(found.targets.size(), false);
    std::vector<bool> matched(truth.targets.size(), false);
    for (const auto& [distance, f, t] : pairs) {
        if (used[f] || matched[t]) continue;
        used[f] = matched[t] = true;
        distances_m_.push_back(distance);
        if (!found.targets[f].covariance_m2) continue;
        ++with_covariance_;
        const core::Vec3 d = found.targets[f].position_m - truth.targets[t].position_m;
        covered_ += d.dot(found.targets[f].covariance_m2->ldlt().solve(d)) <= kChi2_95_3d ? 1 : 0;
    }
}

TrackScores TrackScorer::scores() const {
    TrackScores scores;
    if (!distances_m_.empty()) {
        double squares = 0.0;
        for (const double d : distances_m_) squares += d * d;
        scores.rmse_m = std::sqrt(squares / static_cast<double>(distances_m_.size()));
        scores.median_m = core::upper_median(distances_m_);
    }
    scores.coverage = fraction(covered_, with_covariance_);
    scores.false_alarms = fraction(alarmed_, frames_);
    scores.missed = fraction(there_ - distances_m_.size(), there_);
    if (!latencies_s_.empty()) {
        double sum = 0.0;
        for (const double l : latencies_s_) sum += l;
        scores.latency_s = sum / static_cast<double>(latencies_s_.size());
    }
    return scores;
}

}  // namespace calib
