// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/target_state.h"

#include <vector>

namespace calib {

/// Mean squared position errors that no tracker can go below on average: with the frames up to each
/// one, and with all of them.
struct TrackBound {
    std::vector<double> filtered_m2;
    std::vector<double> smoothed_m2;
};

/// The posterior Cramer-Rao bound along a way.
///
/// information   that each frame holds about position and strength, see fisher_information()
/// first         what is known before the first frame
/// dt_s          from frame to frame
/// source        [Tichavsky1998]
TrackBound track_bound(const std::vector<SeenMatrix>& information,
                       const SeenMatrix& first,
                       const Motion& motion,
                       double dt_s);

}  // namespace calib
