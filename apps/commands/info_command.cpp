// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/commands/describe_file.h"
#include "apps/file_kind.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/run_program.h"
#include "apps/scene_truth.h"
#include "apps/terminal.h"
#include "nlos/canvas/png_file.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/layouts/layout_guess.h"
#include "nlos/pictures/animation.h"
#include "nlos/pictures/picture.h"
#include "nlos/pictures/pictures.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/progress.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/output_file.h"
#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <sstream>
#include <string>

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
    const std::vector<nlos::ImagePanel> panels = nlos::animation_panels(capture, kMostFrames);
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
    std::istringstream words(
        fmt::format("ffmpeg -y -f image2pipe -c:v png -framerate {} -i pipe:0 "
                    "-vf pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white "
                    "-pix_fmt yuv420p -movflags +faststart",
                    frames_per_second));
    std::vector<std::string> command{std::istream_iterator<std::string>(words), {}};
    command.push_back("file:" + output.temporary());
    const auto status =
        run_program(command, std::accumulate(frames.begin(), frames.end(), std::string()));
    if (status != 0) throw core::Failure(path, "ffmpeg could not encode it");
    output.commit();
}

/// Throws core::Error unless a film can be written there: .png, or .mp4 where ffmpeg is installed.
void check_film_path(const std::string& path) {
    require_suffix(path, {".png", ".mp4"});
    if (is_video(path) && !run_program({"ffmpeg", "-version"})) {
        throw core::Error(
            path, "needs ffmpeg, which is not installed", "install it, or name a .png");
    }
}

/// Films the light of a capture: bin by bin, or a sequence frame by frame.
///
/// path     .png, which is animated, or .mp4
/// throws   core::Error as animation_panels() does, core::Failure when ffmpeg fails
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

/// Draws a file: a scene.json as its wall sees it, a capture as streak image, integrated image and
/// mean transient, a volume by its projections and depth map.
///
/// paths          one file, or the frames of a capture
/// picture_path   .png, .svg or .pdf
/// settings       of a capture
/// throws         core::Error for other kinds of files
void write_picture(const std::vector<std::string>& paths,
                   const std::string& picture_path,
                   const nlos::CaptureReadSettings& settings) {
    const std::string& path = paths.front();
    const FileKind kind = kind_of_file(path);
    if (kind == FileKind::Scene) {
        return nlos::write_panels(
            picture_path, nlos::truth_panels(SceneTruth(path).depth_map()), 3);
    }
    if (kind == FileKind::Volume) {
        return nlos::write_panels(picture_path, nlos::volume_panels(nlos::read_volume(path)), 2);
    }
    if (kind == FileKind::Capture) {
        return nlos::write_panels(
            picture_path, nlos::capture_panels(nlos::read_capture(paths, settings)), 3);
    }
    throw core::Error(path, "has no picture", "must be a scene.json, a capture or a volume");
}

struct InfoArguments {
    std::vector<std::string> files;
    std::string picture;
    std::string film;
    std::string write_layout;
    std::vector<std::string> overrides;
};

void write_layout(const std::string& path, const std::string& layout_path) {
    core::check_targets({layout_path}, {path});
    const nlos::LayoutGuess guess = nlos::guess_layout(path);
    if (guess.layout.is_null()) {
        throw core::Error(path, "holds no array that could be histograms", "must hold one");
    }
    core::write_text_file(layout_path, core::json_text(guess.layout));
    for (const std::string& line : guess.findings) print("{}\n", line);
    print_written({layout_path});
}

void draw(const InfoArguments& arguments,
          const nlos::CaptureReadSettings& settings,
          const core::Progress& progress) {
    if (!arguments.picture.empty()) write_picture(arguments.files, arguments.picture, settings);
    if (!arguments.film.empty()) {
        write_film(arguments.film, nlos::read_capture(arguments.files, settings), progress);
    }
    print_written({arguments.picture, arguments.film});
}

void run(const InfoArguments& arguments) {
    const std::vector<std::string>& files = arguments.files;
    if (!arguments.write_layout.empty()) {
        if (files.size() > 1) {
            throw core::Error(files[1], "is a second file", "must be one to write a layout for");
        }
        write_layout(files.front(), arguments.write_layout);
        return;
    }
    nlos::check_picture_suffix(arguments.picture);
    check_film_path(arguments.film);
    core::check_targets({arguments.picture, arguments.film}, files);
    ProgressBar bar("info");
    const nlos::CaptureReadSettings settings = capture_options(arguments.overrides).capture;
    const std::string text = describe_files(files, settings);
    write_message(text);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) outcome()["lines"].push_back(line);
    draw(arguments, settings, bar.progress());
}

void declare_info(Command& command) {
    auto& arguments = command.runs<InfoArguments>(run);
    command.settings = core::settings_help(CaptureOptions{});
    add_file_option(
        command,
        "FILE",
        arguments.files,
        "Capture, volume, scene.json, glTF, OBJ, PLY, STL, fit, metrics or calibration; "
        "several files: the frames of a sequence")
        ->required();
    add_file_option(
        command,
        "--picture",
        arguments.picture,
        "Also draw it (.png, .svg, .pdf): a scene as the wall sees it, a capture, a volume");
    add_file_option(
        command,
        "--film",
        arguments.film,
        "Also film a capture, bin by bin or a sequence frame by frame (.png, which is animated, or "
        ".mp4 by ffmpeg)");
    add_file_option(command,
                    "--write-layout",
                    arguments.write_layout,
                    "Write a layout for a file of named arrays, to be completed (.json)");
    add_capture_options(command, arguments.overrides);
}

}  // namespace

extern const CommandRow kInfoCommand{"info",
                                     "Say what a file is and what it holds",
                                     "nlos info scenes/letter/scene.json",
                                     declare_info};

}  // namespace apps
