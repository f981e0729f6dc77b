// SPDX-License-Identifier: MIT
#pragma once

#include "apps/capture_options.h"
#include "calib/track/track_settings.h"

#include <cstddef>
#include <istream>
#include <string>
#include <vector>

namespace apps {

/// What `nlos track` is asked to do.
struct TrackRequest {
    std::vector<std::string> frames;  ///< a folder, a capture, files that are frames; or `-`
    std::string model;
    std::string output;   ///< TRACK.json; live: empty for none
    std::string csv;      ///< empty: none
    std::string picture;  ///< empty: none
    bool smooth = false;
    std::vector<std::string> overrides;
};

/// What came out, for people.
struct TrackSummary {
    std::size_t frames = 0;
    std::size_t named = 0;  ///< frames that name a target
    double seconds = 0.0;   ///< of tracking alone
    std::vector<std::string> warnings;
};

/// Tracks frames from files into TRACK.json and what goes beside it.
/// throws   core::Error for input and settings that do not fit
TrackSummary track_to_file(const TrackRequest& request);

/// Answers every line of frames by a line at once; a track file is written at the end on request.
TrackSummary track_live(const TrackRequest& request, std::istream& lines);

}  // namespace apps
