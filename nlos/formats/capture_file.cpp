// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_file.h"

#include "nlos/formats/capture_adjustment.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/volume_file.h"
#include "nlos/layouts/layout_capture.h"
#include "nlos/layouts/layout_guess.h"
#include "renderer/core/error.h"
#include "renderer/core/sensor_footprint.h"
#include "renderer/core/settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace nlos {
namespace {

const CaptureFormat* find_format(const std::string& path) {
    // Folders are the layouts' business; whoever opens a pipe or a device may wait for ever.
    if (!std::filesystem::is_regular_file(path)) return nullptr;
    for (const CaptureFormat& format : capture_formats()) {
        if (format.recognise(path)) return &format;
    }
    return nullptr;
}

/// The layout that was asked for, or that of a file or folder in no format of its own.
std::optional<LayoutSource> find_layout_of(const std::string& path,
                                           const CaptureReadSettings& settings) {
    if (!settings.layout.empty()) return layout_source(path, find_layout(settings.layout));
    return find_format(path) == nullptr ? find_layout_source(path) : std::nullopt;
}

/// The same for several files, which must be the frames of a sequence.
std::optional<LayoutSource> find_layout_of(const std::vector<std::string>& paths,
                                           const CaptureReadSettings& settings) {
    for (const std::string& path : paths) {
        if (std::filesystem::exists(path)) continue;
        throw core::Error(path, "does not exist", "must be a capture file");
    }
    auto source = find_layout_of(paths.front(), settings);
    if (paths.size() == 1) return source;
    if (!source) {
        throw core::Error(paths.front(),
                          fmt::format("is the first of {} files and of no layout", paths.size()),
                          "must be of a layout whose files are frames, or stand alone");
    }
    return sequence_source(paths, source->layout);
}

/// The file itself, or the first file of named arrays in a folder.
std::string first_container(const std::string& path) {
    if (!std::filesystem::is_directory(path)) return path;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
        if (container_of(entry.path().string())) return entry.path().string();
    }
    return path;
}

/// What of ours a file is that is no capture, as messages call it; empty for any other.
std::string other_file_of_ours(const std::string& path) {
    const std::string suffix = std::filesystem::path(path).extension().string();
    for (const char* mesh : {".glb", ".gltf", ".obj", ".ply", ".stl"}) {
        if (suffix == mesh) return "a mesh";
    }
    if (is_volume_file(path)) return "a volume";
    if (suffix != ".json") return "";
    const core::Json json = core::read_json_file(path);
    const bool is_scene =
        json.is_object() &&
        (json.contains("geometry") || json.contains("relay_wall") || json.contains("objects"));
    return is_scene ? "a scene" : "";
}

[[noreturn]] void throw_unknown(const std::string& path) {
    const std::string file = first_container(path);
    if (const std::string other = other_file_of_ours(file); !other.empty()) {
        throw core::Error(
            path,
            "is " + other,
            "must be a capture, such as `nlos render SCENE.json -o CAPTURE.h5` makes");
    }
    if (!container_of(file)) {
        throw core::Error(path,
                          "is no capture in a known format",
                          "must be HDF5, MATLAB, NumPy, OpenEXR, .ti, JSON or CSV");
    }
    throw core::Error(path,
                      "is no capture in a known format or layout",
                      fmt::format("`nlos info {}` lists its arrays; the nearest layout is {}",
                                  file,
                                  nearest_layouts(file).at(0)));
}

/// `texts` without repetitions, separated by commas.
std::string join(const std::vector<std::string>& texts) {
    std::string joined;
    for (auto text = texts.begin(); text != texts.end(); ++text) {
        if (std::find(texts.begin(), text, *text) != text) continue;
        joined += (joined.empty() ? "" : ", ") + *text;
    }
    return joined;
}

bool has_suffix(const CaptureWriter& writer, const std::string& suffix) {
    return std::ranges::any_of(
        writer.suffixes, [&](const char* known) { return known != nullptr && suffix == known; });
}

/// How to write by the suffix of `path` and the layout that is asked for.
const CaptureWriter& find_writer(const std::string& path, const std::string& layout) {
    const std::string suffix = std::filesystem::path(path).extension().string();
    std::vector<std::string> layouts;
    std::vector<std::string> suffixes;
    for (const CaptureWriter& writer : capture_writers()) {
        layouts.emplace_back(writer.layout);
        if (!layout.empty() && layout != writer.layout) continue;
        if (has_suffix(writer, suffix)) return writer;
        for (const char* known : writer.suffixes) {
            if (known != nullptr) suffixes.emplace_back(known);
        }
    }
    if (suffixes.empty()) {
        throw core::Error("layout",
                          "'" + layout + "' is none that is written",
                          "must be one of " + join(layouts));
    }
    throw core::Error(
        path,
        "has the suffix '" + suffix + "'",
        "must be one of " + join(suffixes) + (layout.empty() ? "" : " for the layout " + layout));
}

void take_frame(int frame, const std::string& path, core::Capture& capture) {
    const std::size_t count = capture.sequence ? capture.sequence->frames.size() : 1;
    if (static_cast<std::size_t>(frame) >= count) {
        throw core::Error("capture.frame",
                          fmt::format("found {}", frame),
                          fmt::format("must be less than the {} frames of {}", count, path));
    }
    if (!capture.sequence) return;
    const auto later = static_cast<double>(count - 1 - static_cast<std::size_t>(frame));
    capture.time_axis.opl_start_m -= later * capture.sequence->gate_step_m;
    capture.transient = capture.sequence->frames[static_cast<std::size_t>(frame)];
    capture.sequence.reset();
}

void drop_leading_bins(int wanted, core::Capture& capture) {
    const int count = std::min(wanted, capture.time_axis.num_bins);
    if (count <= 0) return;
    core::restrict_observed(capture, {count, capture.time_axis.num_bins});
    capture.notes.push_back(
        fmt::format("the first {} bins (the direct return) are set to 0 and count as not observed; "
                    "capture.zero_bins overrides",
                    count));
}

/// What the observed bins hold.
std::string describe_values(const core::Capture& capture) {
    double sum = 0.0;
    std::optional<std::array<float, 2>> range;
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        for (const float value : capture.observed_values(pair)) {
            sum += value;
            if (!range) range = {value, value};
            range = {std::min((*range)[0], value), std::max((*range)[1], value)};
        }
    }
    const auto [low, high] = range.value_or(std::array{0.0F, 0.0F});
    return fmt::format("histograms: {}, from {:.6g} to {:.6g}, sum {:.6g}",
                       enum_name(capture.unit),
                       low,
                       high,
                       sum);
}

/// Which bins of which points were observed, when not all were.
std::string describe_observed(const core::Capture& capture) {
    const std::vector<core::BinRange>& observed = *capture.observed;
    const std::size_t blind = static_cast<std::size_t>(std::ranges::count_if(
        observed, [](const core::BinRange& range) { return range.size() == 0; }));
    const core::BinRange hull = core::observed_hull(capture.observed, capture.time_axis.num_bins);
    if (hull.size() == 0) return fmt::format("observed: no bin of {} pairs", observed.size());
    const std::size_t whole = static_cast<std::size_t>(std::ranges::count(observed, hull));
    const std::size_t partial = observed.size() - whole - blind;
    const std::size_t most = whole > 0 ? whole : partial;
    std::string text = fmt::format("observed: {}bins {} to {} of {} {} pairs",
                                   whole > 0 ? "" : "parts of ",
                                   hull.begin,
                                   hull.end - 1,
                                   most == observed.size() ? "all" : fmt::format("{} of", most),
                                   observed.size());
    if (whole > 0 && partial > 0) text += fmt::format("; fewer of {}", partial);
    if (blind > 0) text += fmt::format("; {} not at all", blind);
    return text;
}

std::string point_count(const core::WallPoints& points) {
    return points.grid ? fmt::format("{} x {}", (*points.grid)[0], (*points.grid)[1])
                       : fmt::format("{}", points.size());
}

/// Largest extents of the points along x, y and z.
core::Vec3 extents_of(const core::WallPoints& points) {
    core::Vec3 low = points.positions.front();
    core::Vec3 high = low;
    for (const core::Vec3& position : points.positions) {
        low = low.cwiseMin(position);
        high = high.cwiseMax(position);
    }
    return high - low;
}

std::vector<std::string> describe_points(const core::Scan& scan) {
    const core::Vec3 sensed = extents_of(scan.sensing);
    const core::Vec3 lit = extents_of(scan.illumination);
    return {fmt::format("scan: {}, {} sensing points over {:.4g} x {:.4g} x {:.4g} m",
                        enum_name(scan.pattern),
                        point_count(scan.sensing),
                        sensed.x(),
                        sensed.y(),
                        sensed.z()),
            fmt::format("illumination: {} points over {:.4g} x {:.4g} x {:.4g} m",
                        point_count(scan.illumination),
                        lit.x(),
                        lit.y(),
                        lit.z())};
}

std::string point_text(const core::Vec3& point) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", point.x(), point.y(), point.z());
}

std::vector<std::string> describe_camera(const core::PinholeCamera& camera) {
    return {fmt::format("camera: {} x {} pixels, {:.4g} degrees high, at {}, looking at {}",
                        camera.width(),
                        camera.height(),
                        camera.fov_y_deg,
                        point_text(camera.position_m),
                        point_text(camera.look_at_m)),
            fmt::format("light: {} at {}; path lengths run from it to the camera",
                        camera.light_spot_m ? "spot on a surface" : "point",
                        point_text(camera.light_position()))};
}

std::string describe_velocity(const core::VelocityHistogram& velocity) {
    const core::VelocityAxis& axis = velocity.axis;
    double sum = 0.0;
    for (const float value : velocity.values.values()) sum += value;
    const auto shift_hz = [&](double velocity_m_per_s) {
        return core::frequency_shift_hz(axis.carrier_hz, velocity_m_per_s);
    };
    return fmt::format(
        "path velocity{}: {} bins of {:.6g} m/s, from {:.6g} to {:.6g} m/s, sum {:.6g}; at {:.6g} "
        "Hz a shift from {:.6g} to {:.6g} Hz",
        axis.with_time ? " with time" : "",
        axis.num_bins,
        axis.bin_width_m_per_s,
        axis.start_m_per_s,
        axis.end_m_per_s(),
        sum,
        axis.carrier_hz,
        shift_hz(axis.start_m_per_s),
        shift_hz(axis.end_m_per_s()));
}

}  // namespace

core::Capture read_capture(const std::string& path, const CaptureReadSettings& settings) {
    return read_capture(std::vector{path}, settings);
}

core::Capture read_capture(const std::vector<std::string>& paths,
                           const CaptureReadSettings& settings) {
    core::check_ranges(settings, "capture");
    const std::string& path = paths.front();
    core::Capture capture;
    int zero_bins = 0;
    if (const auto source = find_layout_of(paths, settings)) {
        capture = read_layout_capture(*source, settings);
        zero_bins = source->layout.bins.leading_unobserved;
    } else if (const CaptureFormat* format = find_format(path)) {
        capture = format->read(path, settings);
        if (settings.frame) take_frame(*settings.frame, path, capture);
    } else {
        throw_unknown(path);
    }
    drop_leading_bins(settings.zero_bins.value_or(zero_bins), capture);
    validate(capture, path);
    capture = adjust_capture(std::move(capture), settings, path);
    validate(capture, path);
    return capture;
}

std::optional<std::string> capture_format(const std::string& path,
                                          const CaptureReadSettings& settings) {
    if (const auto source = find_layout_of(path, settings)) return source->layout.title;
    if (const CaptureFormat* format = find_format(path)) return format->name;
    return std::nullopt;
}

std::vector<std::string> missing_settings(const std::string& path,
                                          const CaptureReadSettings& settings) {
    const auto source = find_layout_of(path, settings);
    return source ? open_questions(source->layout, settings) : std::vector<std::string>{};
}

std::vector<std::string> write_capture(const std::string& path,
                                       const core::Capture& capture,
                                       const CaptureWriteSettings& settings) {
    const CaptureWriter& writer = find_writer(path, settings.layout);
    validate(capture, path);
    return writer.write(path, capture, settings);
}

void check_capture_suffix(const std::string& path, const CaptureWriteSettings& settings) {
    find_writer(path, settings.layout);
}

std::vector<std::string> describe_capture(const core::Capture& capture) {
    const core::Scan& scan = capture.scan;
    const core::TimeAxis& axis = capture.time_axis;
    std::vector<std::string> lines =
        scan.camera ? describe_camera(*scan.camera) : describe_points(scan);
    if (const auto sensor = core::recorded_sensor(capture)) {
        const std::vector<std::string> of_sensor = core::describe_sensor(*sensor);
        lines.insert(lines.end(), of_sensor.begin(), of_sensor.end());
    }
    lines.push_back(
        fmt::format("time axis: {} bins of {:.6g} m of path length, from {:.6g} to {:.6g} m",
                    axis.num_bins,
                    axis.bin_width_m,
                    axis.opl_start_m,
                    axis.opl_end_m()));
    if (!scan.camera) {
        lines.push_back(
            fmt::format("path lengths {} the legs to laser and detector",
                        scan.opl_origin == core::OplOrigin::Device ? "include" : "exclude"));
    }
    if (capture.observed) lines.push_back(describe_observed(capture));
    if (capture.velocity) lines.push_back(describe_velocity(*capture.velocity));
    if (capture.sequence) {
        lines.push_back(
            fmt::format("frames: {}, {:.6g} s apart, the axis moves by {:.6g} m per frame; what "
                        "else is said here is of the last one",
                        capture.sequence->frames.size(),
                        capture.sequence->frame_s,
                        capture.sequence->gate_step_m));
    }
    lines.push_back(describe_values(capture));
    if (capture.counts_per_radiance) {
        lines.push_back(
            fmt::format("counts per unit of radiance: {:.6g}", *capture.counts_per_radiance));
    }
    if (scan.opl_origin == core::OplOrigin::RelayWall) {
        // Seen at right angles from a confocal point, depth is half the path length.
        const core::BinRange hull = core::observed_hull(capture.observed, axis.num_bins);
        lines.push_back(fmt::format("depth range: {:.4g} to {:.4g} m",
                                    0.5 * std::max(0.0, axis.bin_begin_m(hull.begin)),
                                    0.5 * axis.bin_begin_m(hull.end)));
    }
    lines.insert(lines.end(), capture.notes.begin(), capture.notes.end());
    return lines;
}

}  // namespace nlos
