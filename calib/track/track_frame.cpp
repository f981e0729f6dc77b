// SPDX-License-Identifier: MIT
#include "calib/track/track_frame.h"

#include "renderer/core/error.h"

#include <fmt/core.h>

#include <cmath>

namespace calib {

void validate(const TrackFrame& frame, std::size_t num_zones, std::size_t num_bins) {
    const std::string where =
        frame.name.empty() ? fmt::format("frame at {:.6g} s", frame.time_s) : frame.name;
    core::require(std::isfinite(frame.time_s), where + ", time [s]", frame.time_s, "a number");
    if (frame.pose) core::validate(*frame.pose, core::join_key(where, "pose"));
    if (frame.counts.empty()) return;
    if (frame.counts.size() != num_zones * num_bins) {
        throw core::Error(where,
                          fmt::format("found {} numbers", frame.counts.size()),
                          fmt::format("must be {} zones of {} bins", num_zones, num_bins));
    }
    for (std::size_t i = 0; i < frame.counts.size(); ++i) {
        const double count = frame.counts[i];
        if (count >= 0.0 && std::isfinite(count)) continue;
        throw core::Error(fmt::format("{}, zone {}", where, i / num_bins),
                          fmt::format("found {:.6g} in bin {}", count, i % num_bins),
                          "must hold counts, at least 0; where a background was subtracted, add "
                          "it again");
    }
}

}  // namespace calib
