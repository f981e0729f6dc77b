// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/track_file.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace calib {

/// How good a track is; empty where nothing was there to be scored.
struct TrackScores {
    std::optional<double> rmse_m;    ///< of positions of true targets that were named
    std::optional<double> median_m;  ///< of the same distances
    std::optional<double> coverage;  ///< fraction of true positions in the reported 95 % ellipsoids
    std::optional<double> latency_s;  ///< mean time from a target's appearance to its naming
    std::optional<double>
        false_alarms;              ///< fraction of frames that name more targets than there are
    std::optional<double> missed;  ///< fraction of true targets that were not named
};

/// Adds up scores over tracks.
class TrackScorer {
 public:
    /// Scores frames against the true ones of the same times, to half the truth's frame interval.
    /// Targets are paired by distance, nearest first. Frames that only taught the background count
    /// for nothing.
    ///
    /// throws   core::Error when no times match; `where` names the two in messages
    void add(const std::vector<TrackedFrame>& track,
             const std::vector<TrackedFrame>& truth,
             const std::string& where);

    TrackScores scores() const;

 private:
    void add_frame(const TrackedFrame& found, const TrackedFrame& truth);

    std::vector<double> distances_m_;
    std::vector<double> latencies_s_;
    std::size_t covered_ = 0;
    std::size_t with_covariance_ = 0;
    std::size_t frames_ = 0;
    std::size_t alarmed_ = 0;
    std::size_t there_ = 0;
};

/// Squared Mahalanobis distance within which 95 % of a normal distribution in three dimensions lie.
inline constexpr double kChi2_95_3d = 7.814727903251179;

}  // namespace calib
