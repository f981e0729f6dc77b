// SPDX-License-Identifier: MIT
#include "apps/commands/describe_file.h"

#include "apps/file_kind.h"
#include "calib/fit_file.h"
#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/layouts/layout_guess.h"
#include "nlos/preparation/checks/capture_check.h"
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/capture/recorded_detector.h"
#include "renderer/core/file_suffix.h"
#include "renderer/core/mesh_formats/mesh_formats.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/ranges.h>

namespace apps {
namespace {

void print_range(std::string& out, const char* axis, const std::vector<double>& centers_m) {
    if (centers_m.empty()) return;
    add_line(out,
             "{}: {} voxels, {:.4f} to {:.4f} m",
             axis,
             centers_m.size(),
             centers_m.front(),
             centers_m.back());
}

// One line per key, texts and numbers as they are, lists by their length; and no more than a screen
// or two, since files from elsewhere may hold anything.
class KeyPrinter {
 public:
    explicit KeyPrinter(std::string& text) : out_(text) {}

    void print_keys(const core::Json& json, const std::string& indent) {
        for (const auto& [key, value] : json.items()) {
            if (lines_left_ == 0) {
                add_line(out_, "{}... and more", indent);
                return;
            }
            --lines_left_;
            if (value.is_object() && !value.empty() && key != "settings") {
                add_line(out_, "{}{}:", indent, key);
                print_keys(value, indent + "  ");
            } else if (value.is_array() && (value.size() > 4 || value.flatten().size() > 4)) {
                add_line(out_, "{}{}: {} items", indent, key, value.size());
            } else if (!value.is_null()) {
                add_line(out_, "{}{}: {}", indent, key, text_of(value));
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

    std::string& out_;
    int lines_left_ = 100;
};

void print_provenance(std::string& out, const core::Json& made) {
    if (!made.is_object() || made.empty()) return;
    add_line(out, "provenance:");
    KeyPrinter(out).print_keys(made, "  ");
}

void describe_json(std::string& out, const std::string& path, const char* format) {
    add_line(out, "format: {}", format);
    KeyPrinter(out).print_keys(core::read_json_file(path), "");
}

/// How many there are, and where in the world.
void print_points(std::string& out, const core::PointCloud& points) {
    Eigen::AlignedBox3d box;
    for (const core::Vec3& position : points.positions) box.extend(position);
    std::string place;
    if (!box.isEmpty()) {
        place = fmt::format(", in the world from {} to {} m",
                            core::vector_text(box.min()),
                            core::vector_text(box.max()));
    }
    add_line(out, "surface points: {}{}", points.positions.size(), place);
}

void describe_volume(std::string& out, const std::string& path) {
    const nlos::Reconstruction volume = nlos::read_volume(path);
    add_line(out, "format: reconstructed volume (HDF5)");
    add_line(out, "method: {}", volume.method);
    const nlos::VolumeAxes& axes = volume.volume.axes;
    print_range(out, "wall x", axes.x_m);
    print_range(out, "wall y", axes.y_m);
    print_range(out, "depth from the wall", axes.z_m);
    add_line(out, "wall's frame: {}", nlos::describe_wall_frame(axes.world_from_wall));
    print_points(out, volume.points);
    add_line(out,
             "time: {:.2f} s, peak memory: {:.2f} GB",
             volume.seconds,
             static_cast<double>(volume.peak_bytes) * 1e-9);
    add_line(out, "settings: {}", core::write_value(volume.settings).dump());
    print_provenance(out, *volume.provenance);
}

void describe_ply(std::string& out, const std::string& path) {
    const core::TriangleMesh points = core::read_mesh_file(path).mesh;
    if (!points.triangles.empty()) return describe_geometry(out, path);
    add_line(out, "format: PLY\npoints: {}", points.vertices.size());
}

/// A file in no known format or layout: what it holds and what that could mean.
void describe_unknown(std::string& out, const std::string& path) {
    const nlos::LayoutGuess guess = nlos::guess_layout(path);
    add_line(out,
             "format: {}; arrays:",
             core::file_suffix(path) == ".json" ? "neither a scene nor a known capture"
                                                : "no known capture");
    for (const std::string& line : guess.arrays) add_line(out, "  {}", line);
    add_line(out, "what could be what:");
    for (const std::string& line : guess.findings) add_line(out, "  {}", line);
    add_line(out, "nearest layouts, and what speaks against them:");
    for (const std::string& line : guess.nearest) add_line(out, "  {}", line);
    if (guess.layout.is_null()) return;
    add_line(out,
             "`nlos info {} --write-layout my.json` writes a layout to complete, and --layout "
             "my.json uses it",
             path);
}

void describe_captures(std::string& out,
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
    add_line(out, "format: {}", format.value_or("unknown"));
    for (const std::string& line : nlos::describe_capture(capture)) add_line(out, "{}", line);
    if (const auto* wall = capture.scan.as<core::WallScan>()) {
        const core::Transform pose = nlos::derive_wall_frame(*wall).world_from_wall;
        add_line(out, "wall's frame: {}", nlos::describe_wall_frame(pose));
    }
    const auto response = core::recorded_response(capture);
    if (response) add_line(out, "detector: {}", core::describe(*response));
    if (const auto spot_m = core::recorded_spot_m(capture)) {
        add_line(out, "detector: {}", core::describe_spot(*spot_m));
    }
    print_provenance(out, *capture.scene_info);
    if (!missing.empty()) {
        add_line(out,
                 "warning: the file does not hold what stands as 1 m above: --set {}",
                 fmt::format("{}", fmt::join(missing, " ")));
        return;
    }
    for (const std::string& warning : nlos::capture_warnings(capture)) {
        add_line(out, "warning: {}", warning);
    }
    if (const auto warning = core::detector_warning(capture)) {
        add_line(out, "warning: {}", *warning);
    }
}

void describe_fit(std::string& out, const std::string& path) {
    const calib::FitResult fit = calib::read_fit(path);
    add_line(out,
             "format: fit\n{}converged in {:.2f} s, deviance {:.4g} of {:.4g} expected",
             fit.converged ? "" : "not ",
             fit.seconds,
             fit.deviance,
             fit.expected_deviance);
    for (const calib::FittedObject& object : fit.objects) {
        const auto& p = object.position_m;
        std::string numbers;
        for (const auto& [name, estimate] : object.numbers) {
            numbers += fmt::format(", {} {:.4f}", name, estimate.value);
        }
        add_line(
            out, "{}: at ({:.4f}, {:.4f}, {:.4f}) m{}", object.name, p.x(), p.y(), p.z(), numbers);
    }
    add_line(out, "{} point scatterers", fit.points.size());
}

void describe_one(std::string& out,
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
    std::string out;
    if (paths.size() > 1) {
        describe_captures(out, paths, settings);
    } else {
        describe_one(out, paths.front(), settings);
    }
    return out;
}

}  // namespace apps
