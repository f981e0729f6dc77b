// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/commands.h"
#include "apps/commands/describe_scene.h"
#include "apps/commands/file_picture.h"
#include "apps/file_kind.h"
#include "apps/terminal.h"
#include "calib/fit_file.h"
#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/ply_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/layouts/layout_guess.h"
#include "nlos/preparation/capture_check.h"
#include "renderer/core/output_file.h"
#include "renderer/core/recorded_detector.h"

#include <fmt/ranges.h>

#include <memory>

namespace apps {
namespace {

struct InfoArguments {
    std::vector<std::string> files;
    std::string picture;
    std::string write_layout;
    std::vector<std::string> overrides;
};

void print_range(const char* axis, const std::vector<double>& centers_m) {
    if (centers_m.empty()) return;
    print("{}: {} voxels, {:.4f} to {:.4f} m\n",
          axis,
          centers_m.size(),
          centers_m.front(),
          centers_m.back());
}

// One line per key, texts and numbers as they are, lists by their length; and no more than a screen
// or two, since files from elsewhere may hold anything.
class KeyPrinter {
 public:
    void print_keys(const core::Json& json, const std::string& indent) {
        for (const auto& [key, value] : json.items()) {
            if (lines_left_ == 0) {
                print("{}... and more\n", indent);
                return;
            }
            --lines_left_;
            if (value.is_object() && !value.empty() && key != "settings") {
                print("{}{}:\n", indent, key);
                print_keys(value, indent + "  ");
            } else if (value.is_array() && (value.size() > 4 || value.flatten().size() > 4)) {
                print("{}{}: {} items\n", indent, key, value.size());
            } else if (!value.is_null()) {
                print("{}{}: {}\n", indent, key, text_of(value));
            }
        }
    }

 private:
    static std::string text_of(const core::Json& value) {
        constexpr std::size_t kLongest = 4000;
        std::string text = value.is_string()
                               ? value.get<std::string>()
                               : value.dump(-1, ' ', false, core::Json::error_handler_t::replace);
        if (text.size() > kLongest) text = text.substr(0, kLongest) + " ...";
        return text;
    }

    int lines_left_ = 100;
};

void print_provenance(const core::Json& made) {
    if (!made.is_object() || made.empty()) return;
    print("provenance:\n");
    KeyPrinter().print_keys(made, "  ");
}

void describe_json(const std::string& path, const char* format) {
    print("format: {}\n", format);
    KeyPrinter().print_keys(core::read_json_file(path), "");
}

void describe_volume(const std::string& path) {
    const nlos::Reconstruction volume = nlos::read_volume(path);
    print("format: reconstructed volume (HDF5)\n");
    print("method: {}\n", volume.method);
    print_range("x", volume.volume.axes.x_m);
    print_range("y", volume.volume.axes.y_m);
    print_range("z", volume.volume.axes.z_m);
    print("surface points: {}\n", volume.points.positions.size());
    print("time: {:.2f} s, peak memory: {:.2f} GB\n",
          volume.seconds,
          static_cast<double>(volume.peak_bytes) * 1e-9);
    print("settings: {}\n", core::write_value(volume.settings).dump());
    print_provenance(volume.provenance);
}

void describe_ply(const std::string& path) {
    const core::TriangleMesh points = nlos::read_ply(path);
    if (!points.triangles.empty()) return describe_geometry(path);
    print("format: PLY\npoints: {}\n", points.vertices.size());
}

/// A file in no known format or layout: what it holds and what that could mean.
void describe_unknown(const std::string& path) {
    const nlos::LayoutGuess guess = nlos::guess_layout(path);
    print("format: no known capture; arrays:\n");
    for (const std::string& line : guess.arrays) print("  {}\n", line);
    print("what could be what:\n");
    for (const std::string& line : guess.findings) print("  {}\n", line);
    print("nearest layouts, and what speaks against them:\n");
    for (const std::string& line : guess.nearest) print("  {}\n", line);
    if (guess.layout.is_null()) return;
    print(
        "`nlos info {} --write-layout my.json` writes a layout to complete, and --layout "
        "my.json uses it\n",
        path);
}

void write_layout(const std::string& path, const std::string& layout_path) {
    core::check_targets({layout_path}, {path});
    const nlos::LayoutGuess guess = nlos::guess_layout(path);
    if (guess.layout.is_null()) {
        throw core::Error(path, "holds no array that could be histograms", "must hold one");
    }
    core::write_text_file(layout_path, core::json_text(guess.layout));
    for (const std::string& line : guess.findings) print("{}\n", line);
    print("wrote {}\n", layout_path);
}

void describe_capture_files(const std::vector<std::string>& paths,
                            nlos::CaptureReadSettings settings) {
    const std::string& path = paths.front();
    const auto format = nlos::capture_format(path, settings);
    if (paths.size() == 1 && !format && nlos::container_of(path)) {
        describe_unknown(path);
        return;
    }
    const std::vector<std::string> missing = nlos::missing_settings(path, settings);
    if (!missing.empty()) {
        settings.pitch_m = settings.pitch_m.value_or(1.0);
        settings.bin_width_m = settings.bin_width_m.value_or(1.0);
        settings.wall_size_m = settings.wall_size_m.value_or(std::array{1.0, 1.0});
    }
    core::Capture capture = nlos::read_capture(paths, settings);
    if (!missing.empty()) {
        std::erase_if(capture.notes, [](const auto& note) { return note.ends_with(", as told"); });
    }
    print("format: {}\n", format.value_or("unknown"));
    for (const std::string& line : nlos::describe_capture(capture)) print("{}\n", line);
    print_provenance(capture.scene_info);
    if (!missing.empty()) {
        print("warning: the file does not hold what stands as 1 m above: --set {}\n",
              fmt::format("{}", fmt::join(missing, " ")));
        return;
    }
    for (const std::string& warning : nlos::capture_warnings(capture)) {
        print("warning: {}\n", warning);
    }
    for (const std::string& warning : core::detector_warnings(capture, {})) {
        print("warning: {}\n", warning);
    }
}

void describe_fit(const std::string& path) {
    const calib::FitResult fit = calib::read_fit(path);
    print("format: fit\n{}converged in {:.2f} s, deviance {:.4g} of {:.4g} expected\n",
          fit.converged ? "" : "not ",
          fit.seconds,
          fit.deviance,
          fit.expected_deviance);
    for (const calib::FittedObject& object : fit.objects) {
        const auto& p = object.position_m;
        print("{}: at ({:.4f}, {:.4f}, {:.4f}) m, size {:.4f}, albedo {:.4f}\n",
              object.name,
              p.x(),
              p.y(),
              p.z(),
              object.size,
              object.albedo);
    }
    print("{} point scatterers\n", fit.points.size());
}

void describe_file(const std::string& path, const nlos::CaptureReadSettings& settings) {
    switch (kind_of_file(path)) {
        case FileKind::Scene:
            describe_scene(path);
            break;
        case FileKind::Fit:
            describe_fit(path);
            break;
        case FileKind::Metrics:
            describe_json(path, "metrics");
            break;
        case FileKind::Model:
            describe_json(path, "model of a fit");
            break;
        case FileKind::Setup:
            describe_json(path, "set-up to calibrate");
            break;
        case FileKind::Calibration:
            describe_json(path, "calibration");
            break;
        case FileKind::Geometry:
            describe_geometry(path);
            break;
        case FileKind::PointCloud:
            describe_ply(path);
            break;
        case FileKind::Volume:
            describe_volume(path);
            break;
        case FileKind::Capture:
            describe_capture_files({path}, settings);
            break;
    }
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
    const nlos::CaptureReadSettings settings = capture_options(arguments.overrides).capture;
    if (files.size() > 1) {
        describe_capture_files(files, settings);
    } else {
        describe_file(files.front(), settings);
    }
    if (arguments.picture.empty()) return;
    write_picture(files, arguments.picture, settings);
    print("wrote {}\n", arguments.picture);
}

}  // namespace

void add_info_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("info", "Say what a file is and what it holds");
    const auto arguments = std::make_shared<InfoArguments>();
    command
        ->add_option(
            "FILE",
            arguments->files,
            "Capture, volume, scene.json, glTF, OBJ, PLY, STL, fit, metrics or calibration; "
            "several files: the frames of a sequence")
        ->required();
    command->add_option("--picture",
                        arguments->picture,
                        "Also draw it (.png): a scene as the wall sees it, a capture, a volume");
    command->add_option("--write-layout",
                        arguments->write_layout,
                        "Write a layout for a file of named arrays, to be completed (.json)");
    add_capture_options(*command, arguments->overrides);
    command->footer(settings_footer(core::settings_help(CaptureOptions{}),
                                    "nlos info scenes/letter/scene.json"));
    command->callback([arguments] { run(*arguments); });
}

}  // namespace apps
