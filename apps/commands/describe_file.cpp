// SPDX-License-Identifier: MIT
#include "apps/commands/describe_file.h"

#include "apps/commands/describe_scene.h"
#include "apps/file_kind.h"
#include "calib/fit_file.h"
#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/ply_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/layouts/layout_guess.h"
#include "nlos/preparation/capture_check.h"
#include "renderer/core/capture/recorded_detector.h"

#include <fmt/ranges.h>

namespace apps {
namespace {

void print_range(Description& out, const char* axis, const std::vector<double>& centers_m) {
    if (centers_m.empty()) return;
    out.print("{}: {} voxels, {:.4f} to {:.4f} m\n",
              axis,
              centers_m.size(),
              centers_m.front(),
              centers_m.back());
}

// One line per key, texts and numbers as they are, lists by their length; and no more than a screen
// or two, since files from elsewhere may hold anything.
class KeyPrinter {
 public:
    explicit KeyPrinter(Description& description) : out_(description) {}

    void print_keys(const core::Json& json, const std::string& indent) {
        for (const auto& [key, value] : json.items()) {
            if (lines_left_ == 0) {
                out_.print("{}... and more\n", indent);
                return;
            }
            --lines_left_;
            if (value.is_object() && !value.empty() && key != "settings") {
                out_.print("{}{}:\n", indent, key);
                print_keys(value, indent + "  ");
            } else if (value.is_array() && (value.size() > 4 || value.flatten().size() > 4)) {
                out_.print("{}{}: {} items\n", indent, key, value.size());
            } else if (!value.is_null()) {
                out_.print("{}{}: {}\n", indent, key, text_of(value));
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

    Description& out_;
    int lines_left_ = 100;
};

void print_provenance(Description& out, const core::Json& made) {
    if (!made.is_object() || made.empty()) return;
    out.print("provenance:\n");
    KeyPrinter(out).print_keys(made, "  ");
}

void describe_json(Description& out, const std::string& path, const char* format) {
    out.print("format: {}\n", format);
    KeyPrinter(out).print_keys(core::read_json_file(path), "");
}

void describe_volume(Description& out, const std::string& path) {
    const nlos::Reconstruction volume = nlos::read_volume(path);
    out.print("format: reconstructed volume (HDF5)\n");
    out.print("method: {}\n", volume.method);
    print_range(out, "x", volume.volume.axes.x_m);
    print_range(out, "y", volume.volume.axes.y_m);
    print_range(out, "z", volume.volume.axes.z_m);
    out.print("surface points: {}\n", volume.points.positions.size());
    out.print("time: {:.2f} s, peak memory: {:.2f} GB\n",
              volume.seconds,
              static_cast<double>(volume.peak_bytes) * 1e-9);
    out.print("settings: {}\n", core::write_value(volume.settings).dump());
    print_provenance(out, volume.provenance);
}

void describe_ply(Description& out, const std::string& path) {
    const core::TriangleMesh points = nlos::read_ply(path);
    if (!points.triangles.empty()) return describe_geometry(out, path);
    out.print("format: PLY\npoints: {}\n", points.vertices.size());
}

/// A file in no known format or layout: what it holds and what that could mean.
void describe_unknown(Description& out, const std::string& path) {
    const nlos::LayoutGuess guess = nlos::guess_layout(path);
    out.print("format: no known capture; arrays:\n");
    for (const std::string& line : guess.arrays) out.print("  {}\n", line);
    out.print("what could be what:\n");
    for (const std::string& line : guess.findings) out.print("  {}\n", line);
    out.print("nearest layouts, and what speaks against them:\n");
    for (const std::string& line : guess.nearest) out.print("  {}\n", line);
    if (guess.layout.is_null()) return;
    out.print(
        "`nlos info {} --write-layout my.json` writes a layout to complete, and --layout "
        "my.json uses it\n",
        path);
}

void describe_captures(Description& out,
                       const std::vector<std::string>& paths,
                       nlos::CaptureReadSettings settings) {
    const std::string& path = paths.front();
    const auto format = nlos::capture_format(path, settings);
    if (paths.size() == 1 && !format && nlos::container_of(path)) {
        describe_unknown(out, path);
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
    out.print("format: {}\n", format.value_or("unknown"));
    for (const std::string& line : nlos::describe_capture(capture)) out.print("{}\n", line);
    const auto response = core::recorded_response(capture);
    if (response) out.print("detector: {}\n", core::describe(*response));
    if (const auto spot_m = core::recorded_spot_m(capture)) {
        out.print("detector: {}\n", core::describe_spot(*spot_m));
    }
    print_provenance(out, capture.scene_info);
    if (!missing.empty()) {
        out.print("warning: the file does not hold what stands as 1 m above: --set {}\n",
                  fmt::format("{}", fmt::join(missing, " ")));
        return;
    }
    for (const std::string& warning : nlos::capture_warnings(capture)) {
        out.print("warning: {}\n", warning);
    }
    const auto used = response.value_or(core::ResponseSettings{});
    for (const std::string& warning : core::detector_warnings(capture, used)) {
        out.print("warning: {}\n", warning);
    }
}

void describe_fit(Description& out, const std::string& path) {
    const calib::FitResult fit = calib::read_fit(path);
    out.print("format: fit\n{}converged in {:.2f} s, deviance {:.4g} of {:.4g} expected\n",
              fit.converged ? "" : "not ",
              fit.seconds,
              fit.deviance,
              fit.expected_deviance);
    for (const calib::FittedObject& object : fit.objects) {
        const auto& p = object.position_m;
        out.print("{}: at ({:.4f}, {:.4f}, {:.4f}) m, size {:.4f}, albedo {:.4f}\n",
                  object.name,
                  p.x(),
                  p.y(),
                  p.z(),
                  object.size,
                  object.albedo);
    }
    out.print("{} point scatterers\n", fit.points.size());
}

void describe_one(Description& out,
                  const std::string& path,
                  const nlos::CaptureReadSettings& settings) {
    switch (kind_of_file(path)) {
        case FileKind::Scene:
            return describe_scene(out, path);
        case FileKind::Fit:
            return describe_fit(out, path);
        case FileKind::Metrics:
            return describe_json(out, path, "metrics");
        case FileKind::Model:
            return describe_json(out, path, "model of a fit");
        case FileKind::Setup:
            return describe_json(out, path, "set-up to calibrate");
        case FileKind::Calibration:
            return describe_json(out, path, "calibration");
        case FileKind::Sweep:
            return describe_json(out, path, "sweep over settings");
        case FileKind::Track:
            return describe_json(out, path, "track");
        case FileKind::Geometry:
            return describe_geometry(out, path);
        case FileKind::PointCloud:
            return describe_ply(out, path);
        case FileKind::Volume:
            return describe_volume(out, path);
        case FileKind::Capture:
            return describe_captures(out, {path}, settings);
    }
}

}  // namespace

std::string describe_files(const std::vector<std::string>& paths,
                           const nlos::CaptureReadSettings& settings) {
    Description out;
    if (paths.size() > 1) {
        describe_captures(out, paths, settings);
    } else {
        describe_one(out, paths.front(), settings);
    }
    return out.text();
}

}  // namespace apps
