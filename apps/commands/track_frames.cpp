// SPDX-License-Identifier: MIT
#include "apps/commands/track_frames.h"

#include "nlos/formats/capture_file.h"
#include "nlos/layouts/layout_capture.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/capture/recorded_detector.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;
using calib::TrackFrame;
using calib::TrackSensor;
using calib::TrackSettings;
using core::Json;

constexpr double kUsualFwhm_ps = 1000.0;
constexpr double kUsualFrame_s = 0.1;
constexpr double kWideWall_m = 20.0;

/// What the settings say of the sensor, in place of what is there already.
void apply(const TrackSettings& settings, TrackSensor& sensor) {
    sensor.axis.opl_start_m -= settings.time_zero_m;
    if (settings.response_fwhm_ps) {
        sensor.sigma_m = core::sigma_m_from_fwhm_ps(*settings.response_fwhm_ps);
    }
    if (settings.frame_s) sensor.frame_s = *settings.frame_s;
}

void use_model(const core::SensorModel& model, const TrackSettings& settings, TrackSensor& sensor) {
    core::SensorSetup setup;
    setup.model = model;
    setup.pose = settings.pose.whole();
    setup.poses = settings.poses;
    setup.subsamples = settings.subsamples;
    core::RelayWall wide;
    wide.size_m = {kWideWall_m, kWideWall_m};
    setup.wall = settings.wall.value_or(wide);
    sensor.wall = setup.wall;
    sensor.sigma_m = core::sigma_m_from_fwhm_ps(model.detector.response_fwhm_ps());
    sensor.frame_s = model.detector.frame_s;
    sensor.setup = std::move(setup);
}

/// The number at the end of a file's stem.
std::optional<long> number_of(const std::string& file) {
    const std::string stem = fs::path(file).stem().string();
    std::size_t begin = stem.size();
    while (begin > 0 && stem[begin - 1] >= '0' && stem[begin - 1] <= '9') --begin;
    long number = 0;
    const auto [end, error] =
        std::from_chars(stem.data() + begin, stem.data() + stem.size(), number);
    if (error != std::errc() || end != stem.data() + stem.size()) return std::nullopt;
    return number;
}

/// The numbers of frames after the first, by their files' names where these tell.
std::vector<long> frame_numbers(const std::vector<std::string>& paths, std::size_t count) {
    std::vector<std::string> files = paths;
    if (paths.size() == 1 && fs::is_directory(paths.front())) {
        if (const auto source = nlos::find_layout_source(paths.front())) files = source->files;
    }
    std::vector<long> numbers;
    for (const std::string& file : files) {
        const auto number = number_of(file);
        if (!number || (!numbers.empty() && *number <= numbers.back())) break;
        numbers.push_back(*number);
    }
    if (numbers.size() != count) {
        numbers.clear();
        for (std::size_t i = 0; i < count; ++i) numbers.push_back(static_cast<long>(i));
    }
    const long first = numbers.front();
    for (long& number : numbers) number -= first;
    return numbers;
}

/// Wall points say where light falls; where the sensor stands only matters when it is what moves.
void refuse_unused_pose(const TrackSettings& settings) {
    if (settings.moves_sensor()) return;
    const bool has_poses = !settings.poses.empty();
    if (!has_poses && !settings.pose.is_given()) return;
    throw core::Error(has_poses ? "poses" : "pose",
                      "found for frames that state wall points in place of a sensor",
                      "must come with `sensor`, or be left out");
}

/// Takes from the provenance of a capture what the settings do not state.
void adopt(const core::SensorSetup& recorded, TrackSettings& settings) {
    const bool stands = settings.pose.is_given() || settings.moves_sensor();
    if (settings.poses.empty() && !stands) settings.poses = recorded.poses;
    settings.pose.complete(recorded.pose_of_frame(0));
    if (!settings.wall) settings.wall = recorded.wall;
}

/// The time between frames of a capture, unless the settings state it.
void take_frame_time(const core::Capture& capture,
                     const TrackSettings& settings,
                     TrackFrames& result) {
    if (!capture.sequence || settings.frame_s) return;
    if (capture.sequence->frame_s > 0.0) {
        result.sensor.frame_s = capture.sequence->frame_s;
        return;
    }
    result.warnings.push_back(
        fmt::format("the frames do not say how far apart they are: {:.4g} s{}; frame_s states it",
                    result.sensor.frame_s,
                    result.sensor.setup ? ", as the sensor takes for one" : " are assumed"));
}

/// The sensor of a capture: that of the settings, that of its provenance, or its wall points.
TrackSensor sensor_of(const core::Capture& capture,
                      const std::string& name,
                      TrackSettings& settings) {
    TrackSensor sensor;
    sensor.axis = capture.time_axis;
    sensor.frame_s = kUsualFrame_s;
    sensor.sigma_m = core::sigma_m_from_fwhm_ps(kUsualFwhm_ps);
    sensor.opl_origin = capture.scan.opl_origin();
    const auto recorded = core::recorded_sensor(capture);
    if (recorded) adopt(*recorded, settings);
    if (!settings.sensor.empty()) {
        use_model(core::read_sensor_model(settings.sensor), settings, sensor);
    } else if (recorded) {
        use_model(recorded->model, settings, sensor);
    } else {
        refuse_unused_pose(settings);
        sensor.spots_m = capture.scan.wall().sensing.positions;
        sensor.wall = settings.wall ? *settings.wall : calib::wall_through(sensor.spots_m, name);
        const core::Devices devices = capture.scan.devices();
        sensor.device_m = 0.5 * (devices.laser + devices.detector);
        if (const auto response = core::recorded_response(capture)) {
            sensor.sigma_m = core::sigma_m_from_fwhm_ps(response->jitter_fwhm_ps);
        }
    }
    if (sensor.num_zones() != capture.scan.num_pairs()) {
        throw core::Error(name,
                          fmt::format("has {} histograms for {} zones of the sensor",
                                      capture.scan.num_pairs(),
                                      sensor.num_zones()),
                          "must have one per zone");
    }
    apply(settings, sensor);
    return sensor;
}

}  // namespace

TrackSensor given_sensor(const TrackSettings& settings) {
    if (settings.sensor.empty()) {
        throw core::Error(
            "sensor", "is not given", "must name the sensor of frames that come as lines");
    }
    TrackSensor sensor;
    const core::SensorModel model = core::read_sensor_model(settings.sensor);
    use_model(model, settings, sensor);
    sensor.axis = model.time_axis();
    apply(settings, sensor);
    return sensor;
}

TrackFrames read_track_frames(const std::vector<std::string>& paths,
                              TrackSettings& settings,
                              const nlos::CaptureReadSettings& reading) {
    const core::Capture capture = paths.size() == 1 ? nlos::read_capture(paths.front(), reading)
                                                    : nlos::read_capture(paths, reading);
    TrackFrames result;
    result.sensor = sensor_of(capture, paths.front(), settings);
    take_frame_time(capture, settings, result);
    const std::vector<core::Transient> single{capture.transient};
    const auto& frames = capture.sequence ? capture.sequence->frames : single;
    if (!settings.poses.empty() && settings.poses.size() != frames.size()) {
        throw core::Error(
            "poses",
            fmt::format("found {} for {} frames", settings.poses.size(), frames.size()),
            "must be one per frame, or none");
    }
    const std::vector<long> numbers = frame_numbers(paths, frames.size());
    for (std::size_t f = 0; f < frames.size(); ++f) {
        TrackFrame frame;
        frame.name = fmt::format("{}: frame {}", paths.front(), f);
        frame.time_s = static_cast<double>(numbers[f]) * result.sensor.frame_s;
        const auto values = frames[f].values();
        frame.counts.assign(values.begin(), values.end());
        frame.observed = capture.observed;
        if (!settings.poses.empty()) frame.pose = settings.poses[f];
        result.frames.push_back(std::move(frame));
    }
    const long missing = numbers.back() + 1 - static_cast<long>(numbers.size());
    if (missing > 0) {
        result.warnings.push_back(
            fmt::format("{} of {} frames are missing; targets are moved on without them",
                        missing,
                        numbers.back() + 1));
    }
    return result;
}

TrackFrames read_background_frames(const TrackSettings& settings,
                                   const TrackSensor& sensor,
                                   const nlos::CaptureReadSettings& reading) {
    TrackSettings of_file = settings;
    of_file.poses.clear();
    of_file.pose = {};
    TrackFrames background = read_track_frames({settings.background.file}, of_file, reading);
    const core::TimeAxis& found = background.sensor.axis;
    constexpr double kSame_bins = 1e-3;
    const double same_m = kSame_bins * sensor.axis.bin_width_m;
    if (background.sensor.num_zones() != sensor.num_zones() ||
        found.num_bins != sensor.axis.num_bins ||
        !(std::abs(found.opl_start_m - sensor.axis.opl_start_m) <= same_m) ||
        !(std::abs(found.opl_end_m() - sensor.axis.opl_end_m()) <= same_m)) {
        const auto text = [](const TrackSensor& s) {
            return fmt::format("{} zones of {} bins from {:.4g} to {:.4g} m",
                               s.num_zones(),
                               s.axis.num_bins,
                               s.axis.opl_start_m,
                               s.axis.opl_end_m());
        };
        throw core::Error(settings.background.file,
                          "found " + text(background.sensor),
                          "must be as the frames: " + text(sensor));
    }
    return background;
}

FrameLines::FrameLines(std::istream& lines, const TrackSensor& sensor)
    : lines_(lines),
      num_zones_(sensor.num_zones()),
      num_bins_(static_cast<std::size_t>(sensor.axis.num_bins)),
      frame_s_(sensor.frame_s) {}

std::optional<TrackFrame> FrameLines::next() {
    std::string text;
    do {
        if (!std::getline(lines_, text)) return std::nullopt;
        ++line_;
    } while (text.find_first_not_of(" \t\r") == std::string::npos);
    const std::string where = fmt::format("line {}", line_);
    const Json json = core::parse_json(text, where);
    if (!json.is_object()) core::throw_wrong_type(where, json, "an object with histograms");
    core::check_keys(json, where, {"t", "histograms", "pose"});
    TrackFrame frame;
    frame.name = where;
    frame.time_s = last_time_s_ ? *last_time_s_ + frame_s_ : 0.0;
    if (json.contains("t")) core::read_value(json["t"], where + ".t", frame.time_s);
    last_time_s_ = frame.time_s;
    if (json.contains("pose") && !json["pose"].is_null()) {
        core::read_value(json["pose"], where + ".pose", frame.pose);
    }
    if (!json.contains("histograms")) {
        throw core::Error(where + ".histograms", "is missing", "must be bins per zone, or null");
    }
    if (json["histograms"].is_null()) return frame;
    std::vector<std::vector<double>> zones;
    core::read_value(json["histograms"], where + ".histograms", zones);
    core::require(zones.size() == num_zones_,
                  where + ".histograms, number of zones",
                  static_cast<double>(zones.size()),
                  std::to_string(num_zones_));
    for (std::size_t z = 0; z < zones.size(); ++z) {
        const std::string zone = fmt::format("{}.histograms[{}]", where, z);
        core::require(zones[z].size() == num_bins_,
                      zone + ", number of bins",
                      static_cast<double>(zones[z].size()),
                      std::to_string(num_bins_));
        frame.counts.insert(frame.counts.end(), zones[z].begin(), zones[z].end());
    }
    return frame;
}

}  // namespace apps
