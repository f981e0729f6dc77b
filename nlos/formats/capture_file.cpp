// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_file.h"

#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/volume_file.h"
#include "nlos/layouts/layout_capture.h"
#include "nlos/layouts/layout_guess.h"
#include "renderer/core/error.h"
#include "renderer/core/file_suffix.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/settings/settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

namespace nlos {
namespace {

/// How a file or folder is read: by a format of its own or by a layout, or not at all.
struct Reading {
    std::string name;  ///< of the format or layout; empty: neither
    CaptureFormat::Read by_format;
    std::optional<LayoutSource> by_layout;
};

Reading by_layout(std::optional<LayoutSource> source) {
    std::string name = source ? source->layout.title : "";
    return {std::move(name), nullptr, std::move(source)};
}

/// By the layout that was asked for, the file's format, or a layout that fits.
Reading find_reading(const std::string& path, const CaptureReadSettings& settings) {
    if (!settings.layout.empty()) {
        return by_layout(layout_source(path, find_layout(settings.layout)));
    }
    // Folders are the layouts' business; whoever opens a pipe or a device may wait for ever.
    if (std::filesystem::is_regular_file(path)) {
        for (const CaptureFormat& format : capture_formats()) {
            if (auto read = format.open(path)) return {format.name, std::move(read), std::nullopt};
        }
    }
    return by_layout(find_layout_source(path));
}

/// The same for several files, which must be the frames of a sequence.
Reading find_reading(const std::vector<std::string>& paths, const CaptureReadSettings& settings) {
    for (const std::string& path : paths) {
        if (std::filesystem::exists(path)) continue;
        throw core::Error(path, "does not exist", "must be a capture file");
    }
    Reading reading = find_reading(paths.front(), settings);
    if (paths.size() == 1) return reading;
    if (!reading.by_layout) {
        throw core::Error(paths.front(),
                          fmt::format("is the first of {} files and of no layout", paths.size()),
                          "must be of a layout whose files are frames, or stand alone");
    }
    return by_layout(sequence_source(paths, reading.by_layout->layout));
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
    const std::string suffix = core::file_suffix(path);
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
    const std::string suffix = core::file_suffix(path);
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
    capture.observed = capture.observed_in_frame(static_cast<std::size_t>(frame));
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
    const Reading reading = find_reading(paths, settings);
    if (reading.by_layout) {
        capture = read_layout_capture(*reading.by_layout, settings);
        zero_bins = reading.by_layout->layout.bins.leading_unobserved;
    } else if (reading.by_format) {
        capture = reading.by_format(settings);
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
    const Reading reading = find_reading(path, settings);
    return reading.name.empty() ? std::nullopt : std::optional(reading.name);
}

std::vector<std::string> missing_settings(const std::string& path,
                                          const CaptureReadSettings& settings) {
    const auto source = find_reading(path, settings).by_layout;
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

}  // namespace nlos
