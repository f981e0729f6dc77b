// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/commands.h"
#include "apps/commands/describe_file.h"
#include "apps/commands/file_picture.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "nlos/layouts/layout_guess.h"
#include "renderer/core/output_file.h"

#include <memory>
#include <sstream>

namespace apps {
namespace {

struct InfoArguments {
    std::vector<std::string> files;
    std::string picture;
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
    note_written({layout_path});
    print("wrote {}\n", layout_path);
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
    const ProgressBar bar("info");
    const nlos::CaptureReadSettings settings = capture_options(arguments.overrides).capture;
    const std::string text = describe_files(files, settings);
    write_message(text);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) outcome()["lines"].push_back(line);
    if (arguments.picture.empty()) return;
    write_picture(files, arguments.picture, settings);
    note_written({arguments.picture});
    print("wrote {}\n", arguments.picture);
}

}  // namespace

void add_info_command(CLI::App& app) {
    Command& command = add_command(app, "info", "Say what a file is and what it holds");
    command.settings = core::settings_help(CaptureOptions{});
    const auto arguments = std::make_shared<InfoArguments>();
    add_file_option(
        command,
        "FILE",
        arguments->files,
        "Capture, volume, scene.json, glTF, OBJ, PLY, STL, fit, metrics or calibration; "
        "several files: the frames of a sequence")
        ->required();
    add_file_option(command,
                    "--picture",
                    arguments->picture,
                    "Also draw it (.png): a scene as the wall sees it, a capture, a volume");
    add_file_option(command,
                    "--write-layout",
                    arguments->write_layout,
                    "Write a layout for a file of named arrays, to be completed (.json)");
    add_capture_options(command, arguments->overrides);
    command.example = "nlos info scenes/letter/scene.json";
    command.callback([arguments] { run(*arguments); });
}

}  // namespace apps
