// SPDX-License-Identifier: MIT
#include "apps/commands/film_file.h"

#include "apps/arguments.h"
#include "apps/run_program.h"
#include "nlos/canvas/animated_png.h"
#include "nlos/pictures/film.h"
#include "nlos/pictures/picture.h"
#include "renderer/core/output_file.h"
#include "renderer/core/parallel.h"

#include <algorithm>
#include <numeric>

namespace apps {
namespace {

constexpr std::size_t kMostFrames = 300;
constexpr std::size_t kDuration_s = 10;  // where frames are neither too few nor too many for it
constexpr std::size_t kSlowest = 4;      // [frames/s]
constexpr std::size_t kFastest = 25;

bool is_video(const std::string& path) {
    return path.ends_with(".mp4");
}

/// Every frame as a PNG file.
std::vector<std::string> draw_frames(const core::Capture& capture, const core::Progress& progress) {
    const std::vector<nlos::ImagePanel> panels = nlos::film_panels(capture, kMostFrames);
    std::vector<std::string> frames;
    core::parallel_in_order<std::string>(
        panels.size(),
        [&](std::size_t i) { return nlos::encode_panels({panels[i]}, 1); },
        [&](std::size_t i, std::string frame) {
            frames.push_back(std::move(frame));
            progress.update(static_cast<double>(i + 1) / static_cast<double>(panels.size()), "");
            return true;
        });
    return frames;
}

/// Has ffmpeg encode the frames, as every player takes them: an even number of pixels either way.
void write_video(const std::string& path,
                 const std::vector<std::string>& frames,
                 std::size_t frames_per_second) {
    core::OutputFile output(path);
    const auto status = run_program({"ffmpeg",
                                     "-y",
                                     "-f",
                                     "image2pipe",
                                     "-c:v",
                                     "png",
                                     "-framerate",
                                     std::to_string(frames_per_second),
                                     "-i",
                                     "pipe:0",
                                     "-vf",
                                     "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
                                     "-pix_fmt",
                                     "yuv420p",
                                     "-movflags",
                                     "+faststart",
                                     "file:" + output.temporary()},
                                    std::accumulate(frames.begin(), frames.end(), std::string()));
    if (status != 0) throw core::Failure(path, "ffmpeg could not encode it");
    output.commit();
}

}  // namespace

void check_film_path(const std::string& path) {
    require_suffix(path, {".png", ".mp4"});
    if (is_video(path) && !run_program({"ffmpeg", "-version"})) {
        throw core::Error(
            path, "needs ffmpeg, which is not installed", "install it, or name a .png");
    }
}

void write_film(const std::string& path,
                const core::Capture& capture,
                const core::Progress& progress) {
    const std::vector<std::string> frames = draw_frames(capture, progress);
    const std::size_t speed = std::clamp(frames.size() / kDuration_s, kSlowest, kFastest);
    if (is_video(path)) {
        write_video(path, frames, speed);
    } else {
        core::write_text_file(path, nlos::join_animated_png(frames, static_cast<int>(speed)));
    }
}

}  // namespace apps
