// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/commands.h"
#include "apps/commands/describe_scene.h"
#include "apps/commands/file_picture.h"
#include "apps/file_kind.h"
#include "calib/fit_file.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/ply_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/preparation/capture_check.h"
#include "renderer/core/recorded_detector.h"

#include <fmt/core.h>

#include <memory>

namespace apps {
namespace {

struct InfoArguments {
    std::string file;
    std::string picture;
    std::vector<std::string> overrides;
};

void print_range(const char* axis, const std::vector<double>& centers_m) {
    if (centers_m.empty()) return;
    fmt::print("{}: {} voxels, {:.4f} to {:.4f} m\n",
               axis,
               centers_m.size(),
               centers_m.front(),
               centers_m.back());
}

// One line per key, texts and numbers as they are, lists by their length; and no more than a screen
// or two, since files from elsewhere may hold anything.
class KeyPrinter {
 public:
    void print(const core::Json& json, const std::string& indent) {
        for (const auto& [key, value] : json.items()) {
            if (lines_left_ == 0) {
                fmt::print("{}... and more\n", indent);
                return;
            }
            --lines_left_;
            if (value.is_object() && !value.empty() && key != "settings") {
                fmt::print("{}{}:\n", indent, key);
                print(value, indent + "  ");
            } else if (value.is_array() && (value.size() > 4 || value.flatten().size() > 4)) {
                fmt::print("{}{}: {} items\n", indent, key, value.size());
            } else if (!value.is_null()) {
                fmt::print("{}{}: {}\n", indent, key, text_of(value));
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
    fmt::print("provenance:\n");
    KeyPrinter().print(made, "  ");
}

void describe_json(const std::string& path, const char* format) {
    fmt::print("format: {}\n", format);
    KeyPrinter().print(core::read_json_file(path), "");
}

void describe_volume(const std::string& path) {
    const nlos::Reconstruction volume = nlos::read_volume(path);
    fmt::print("format: reconstructed volume (HDF5)\n");
    fmt::print("method: {}\n", volume.method);
    print_range("x", volume.volume.axes.x_m);
    print_range("y", volume.volume.axes.y_m);
    print_range("z", volume.volume.axes.z_m);
    fmt::print("surface points: {}\n", volume.points.positions.size());
    fmt::print("time: {:.2f} s, peak memory: {:.2f} GB\n",
               volume.seconds,
               static_cast<double>(volume.peak_bytes) * 1e-9);
    fmt::print("settings: {}\n", core::write_value(volume.settings).dump());
    print_provenance(volume.provenance);
}

void describe_ply(const std::string& path) {
    const core::TriangleMesh points = nlos::read_ply(path);
    if (!points.triangles.empty()) return describe_geometry(path);
    fmt::print("format: PLY\npoints: {}\n", points.vertices.size());
}

void describe_capture_file(const std::string& path, const std::vector<std::string>& overrides) {
    nlos::CaptureReadSettings settings = capture_options(overrides).capture;
    const bool in_steps = nlos::lacks_scale(path) && !(settings.pitch_m && settings.bin_width_m);
    if (in_steps) {
        settings.pitch_m = settings.pitch_m.value_or(1.0);
        settings.bin_width_m = settings.bin_width_m.value_or(1.0);
    }
    const core::Capture capture = nlos::read_capture(path, settings);
    fmt::print("format: {}\n", nlos::capture_format(path).value_or("unknown"));
    for (const std::string& line : nlos::describe_capture(capture)) fmt::print("{}\n", line);
    print_provenance(capture.scene_info);
    if (in_steps) {
        fmt::print(
            "warning: the file holds neither the grid's pitch nor the bin width; what is not given "
            "as --set capture.pitch_m=... capture.bin_width_m=... stands as 1 m above\n");
        return;
    }
    for (const std::string& warning : nlos::capture_warnings(capture)) {
        fmt::print("warning: {}\n", warning);
    }
    for (const std::string& warning : core::detector_warnings(capture, {})) {
        fmt::print("warning: {}\n", warning);
    }
}

void describe_fit(const std::string& path) {
    const calib::FitResult fit = calib::read_fit(path);
    fmt::print("format: fit\n{}converged in {:.2f} s, deviance {:.4g} of {:.4g} expected\n",
               fit.converged ? "" : "not ",
               fit.seconds,
               fit.deviance,
               fit.expected_deviance);
    for (const calib::FittedObject& object : fit.objects) {
        const auto& p = object.position_m;
        fmt::print("{}: at ({:.4f}, {:.4f}, {:.4f}) m, size {:.4f}, albedo {:.4f}\n",
                   object.name,
                   p.x(),
                   p.y(),
                   p.z(),
                   object.size,
                   object.albedo);
    }
    fmt::print("{} point scatterers\n", fit.points.size());
}

void run(const InfoArguments& arguments) {
    switch (kind_of_file(arguments.file)) {
        case FileKind::Scene:
            describe_scene(arguments.file);
            break;
        case FileKind::Fit:
            describe_fit(arguments.file);
            break;
        case FileKind::Metrics:
            describe_json(arguments.file, "metrics");
            break;
        case FileKind::Model:
            describe_json(arguments.file, "model of a fit");
            break;
        case FileKind::Setup:
            describe_json(arguments.file, "set-up to calibrate");
            break;
        case FileKind::Calibration:
            describe_json(arguments.file, "calibration");
            break;
        case FileKind::Geometry:
            describe_geometry(arguments.file);
            break;
        case FileKind::PointCloud:
            describe_ply(arguments.file);
            break;
        case FileKind::Volume:
            describe_volume(arguments.file);
            break;
        case FileKind::Capture:
            describe_capture_file(arguments.file, arguments.overrides);
            break;
    }
    if (arguments.picture.empty()) return;
    write_picture(arguments.file, arguments.picture);
    fmt::print("wrote {}\n", arguments.picture);
}

}  // namespace

void add_info_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("info", "Say what a file is and what it holds");
    const auto arguments = std::make_shared<InfoArguments>();
    command
        ->add_option(
            "FILE",
            arguments->file,
            "Capture, volume, scene.json, glTF, OBJ, PLY, STL, fit, metrics or calibration")
        ->required();
    command->add_option("--picture",
                        arguments->picture,
                        "Also draw it (.png): a scene as the wall sees it, a capture, a volume");
    add_set_option(*command, arguments->overrides);
    command->footer(settings_footer(core::settings_help(CaptureOptions{}),
                                    "nlos info scenes/letter/scene.json"));
    command->callback([arguments] { run(*arguments); });
}

}  // namespace apps
