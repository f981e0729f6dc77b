// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/commands/track_job.h"
#include "apps/outcome.h"
#include "apps/terminal.h"
#include "renderer/core/error.h"

#include <iostream>

namespace apps {
namespace {

void run(const TrackRequest& given) {
    TrackRequest request = given;
    // The last word that is no option is the model.
    if (request.frames.size() < 2) {
        throw core::Error("track", "found one file", "must be FRAMES and MODEL.json");
    }
    request.model = request.frames.back();
    request.frames.pop_back();
    const bool live = request.frames == std::vector<std::string>{"-"};
    if (!live && request.output.empty()) {
        throw core::Error("--output", "is missing", "must name the track to write (.json)");
    }
    const TrackSummary summary = live ? track_live(request, std::cin) : track_to_file(request);
    for (const std::string& text : summary.warnings) warn(text);
    const std::string written = note_written({request.output, request.csv, request.picture});
    outcome()["frames"] = summary.frames;
    outcome()["frames_with_a_target"] = summary.named;
    outcome()["seconds_track"] = summary.seconds;
    if (live) return;
    print("wrote {} ({} frames, {} with a target, {:.0f} frames/s)\n",
          written,
          summary.frames,
          summary.named,
          static_cast<double>(summary.frames) / std::max(summary.seconds, 1e-9));
}

void declare_track(Command& command) {
    auto& request = command.runs<TrackRequest>(run);
    command.settings = core::settings_help(WithCapture<calib::TrackSettings>{});
    add_file_option(command,
                    "FILES",
                    request.frames,
                    "Frames: a folder, a sequence capture, files that are frames, or - for a line "
                    "of JSON each on standard input; then what counted them and what is tracked "
                    "(.json)")
        ->required();
    add_output_option(command, request.output, "Track to write (.json); may be left out with -");
    add_file_option(command,
                    "--csv",
                    request.csv,
                    "Table to write (.csv): a line per frame and target, places in the world");
    add_file_option(command,
                    "--picture",
                    request.picture,
                    "Picture to write (.png, .svg, .pdf): plan, histograms and model");
    command.add_flag("--smooth", request.smooth, "Use later frames too, once all are there");
    add_capture_options(command, request.overrides);
}

}  // namespace

extern const CommandRow kTrackCommand{
    "track",
    "Track hidden targets with a histogram camera",
    "nlos track data/walk/counts.h5 data/walk/track.json -o track.json --picture track.png",
    declare_track};

}  // namespace apps
