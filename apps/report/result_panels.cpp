// SPDX-License-Identifier: MIT
#include "apps/report/result_panels.h"

#include "apps/estimate_text.h"
#include "calib/fit_file.h"
#include "calib/track/track_file.h"
#include "nlos/pictures/light_scale.h"
#include "nlos/pictures/pictures.h"
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;

constexpr int kCaptureColumns = 3;
constexpr int kVolumeColumns = 2;

std::string range_text(double low, double high, const std::string& unit) {
    return fmt::format("{} to {} {}", short_number(low), short_number(high), unit);
}

std::string points_text(const core::WallPoints& points) {
    if (!points.grid) return fmt::format("{} (list)", points.size());
    return fmt::format("{} x {}", (*points.grid)[0], (*points.grid)[1]);
}

std::vector<Fact> scan_facts(const core::ImageScan& image) {
    const core::PinholeCamera& camera = image.camera;
    return {{"Camera", fmt::format("{} x {} pixels", camera.width(), camera.height())},
            {"Angle of view", short_number(camera.fov_y_deg) + " degrees high"},
            {"Light", camera.light_spot_m ? "spot on a surface" : "point"}};
}

std::vector<Fact> scan_facts(const core::WallScan& scan) {
    const nlos::WallFrame frame = nlos::derive_wall_frame(scan);
    std::vector<Fact> facts{{"Scan", std::string(core::enum_name(scan.pattern))},
                            {"Sensing points", points_text(scan.sensing)}};
    if (!scan.is_confocal()) {
        facts.emplace_back("Illumination points", points_text(scan.illumination));
    }
    facts.emplace_back("Wall covered",
                       fmt::format("{} x {} m",
                                   short_number(frame.max_m[0] - frame.min_m[0]),
                                   short_number(frame.max_m[1] - frame.min_m[1])));
    return facts;
}

std::string path_origin(const core::Scan& scan) {
    if (!scan.has_wall()) return "the light";
    return scan.opl_origin() == core::OplOrigin::Device ? "the device" : "the relay wall";
}

std::vector<Fact> capture_facts(const core::Capture& capture) {
    const core::TimeAxis& axis = capture.time_axis;
    const auto values = capture.transient.values();
    double total = 0.0;
    for (const float value : values) total += value;
    std::vector<Fact> facts = capture.scan.visit([](const auto& kind) { return scan_facts(kind); });
    if (capture.sequence) {
        facts.emplace_back(
            "Frames, of which H is the last",
            fmt::format("{}, the path length moves by {} mm and time by {} s per frame",
                        capture.sequence->frames.size(),
                        short_number(1e3 * capture.sequence->gate_step_m),
                        short_number(capture.sequence->frame_s)));
    }
    if (capture.velocity) {
        const core::VelocityAxis& velocity = capture.velocity->axis;
        facts.emplace_back("Path velocity",
                           range_text(velocity.start_m_per_s, velocity.end_m_per_s(), "m/s"));
        facts.emplace_back(
            fmt::format("Frequency shift at {} GHz", short_number(1e-9 * velocity.carrier_hz)),
            range_text(1e-3 * core::frequency_shift_hz(velocity.carrier_hz, velocity.start_m_per_s),
                       1e-3 * core::frequency_shift_hz(velocity.carrier_hz, velocity.end_m_per_s()),
                       "kHz"));
    }
    facts.insert(
        facts.end(),
        {{"Bins",
          fmt::format("{} of {} mm of path", axis.num_bins, short_number(1e3 * axis.bin_width_m))},
         {"Path length", range_text(axis.opl_start_m, axis.opl_end_m(), "m")},
         {"Path begins at", path_origin(capture.scan)},
         {"Unit", nlos::light_label(capture)},
         {"Largest value", short_number(*std::max_element(values.begin(), values.end()))},
         {"Sum of all values", short_number(total)}});
    return facts;
}

double pitch_mm(const std::vector<double>& centres_m) {
    if (centres_m.size() < 2) return 0.0;
    return 1e3 * (centres_m.back() - centres_m.front()) / static_cast<double>(centres_m.size() - 1);
}

std::vector<Fact> volume_facts(const nlos::Reconstruction& result) {
    const nlos::VolumeAxes& axes = result.volume.axes;
    std::vector<Fact> facts{{"Method", result.method}};
    if (!result.reason.empty()) facts.emplace_back("Chosen because", result.reason);
    facts.insert(
        facts.end(),
        {{"Voxels", fmt::format("{} x {} x {}", axes.x_m.size(), axes.y_m.size(), axes.z_m.size())},
         {"Voxel size",
          fmt::format("{} x {} x {} mm",
                      short_number(pitch_mm(axes.x_m)),
                      short_number(pitch_mm(axes.y_m)),
                      short_number(pitch_mm(axes.z_m)))}});
    if (!axes.z_m.empty()) {
        facts.emplace_back("Depth range", range_text(axes.z_m.front(), axes.z_m.back(), "m"));
    }
    facts.emplace_back("Surface points", fmt::format("{}", result.points.positions.size()));
    facts.emplace_back("Time", short_number(result.seconds) + " s");
    if (result.peak_bytes > 0) {
        facts.emplace_back("Peak memory",
                           short_number(static_cast<double>(result.peak_bytes) / 1e6) + " MB");
    }
    facts.emplace_back("Wall's frame", nlos::describe_wall_frame(axes.world_from_wall));
    return facts;
}

std::string position_text(const core::Vec3& position_m, const core::Vec3& sigma_m) {
    std::string text;
    for (int a = 0; a < 3; ++a) {
        text += (a == 0 ? "" : ", ") + estimate_text(1e3 * position_m[a], 1e3 * sigma_m[a]);
    }
    return "(" + text + ") mm";
}

std::vector<Fact> fit_facts(const calib::FitResult& fit, const core::Json& json) {
    std::vector<Fact> facts;
    for (const calib::FittedObject& object : fit.objects) {
        std::string text = position_text(object.position_m, object.position_sigma_m);
        if (object.rotation_sigma_deg.norm() > 0.0) {
            text += ", turned +- " + short_number(object.rotation_sigma_deg.norm()) + " deg";
        }
        for (const auto& [name, estimate] : object.numbers) {
            text += ", " + name + " " + estimate_text(estimate.value, estimate.sigma);
        }
        facts.emplace_back(object.name, text);
    }
    for (std::size_t i = 0; i < fit.points.size(); ++i) {
        facts.emplace_back(fmt::format("Point {}", i),
                           position_text(fit.points[i].position_m, fit.points[i].position_sigma_m));
    }
    const auto number = [&](const char* key) {
        const auto it = json.find(key);
        return it != json.end() && it->is_number() ? short_number(it->get<double>()) : "unknown";
    };
    facts.insert(
        facts.end(),
        {{"Time zero", number("time_zero_m") + " m"},
         {"Ambient light per bin", number("ambient")},
         {"Response", number("response_fwhm_ps") + " ps"},
         {"Residual", json.value("residual", "unknown")},
         {"Deviance, and expected", number("deviance") + ", " + number("expected_deviance")},
         {"Condition number", number("condition_number")},
         {"Iterations", number("iterations")},
         {"Time", number("seconds") + " s"},
         {"Converged", fit.converged ? "yes" : "no: " + json.value("message", "")}});
    return facts;
}

}  // namespace

std::string short_number(double value) {
    const double size = std::abs(value);
    if (size == 0.0) return "0";
    if (size < 1e-3 || size >= 1e6) return fmt::format("{:.2e}", value);
    if (size >= 100.0) return fmt::format("{:.0f}", value);
    return fmt::format("{:.3g}", value);
}

std::string shown_file(const std::filesystem::path& path) {
    return core::printable(path.filename().string());
}

std::string read_bytes(const std::string& path) {
    const core::MappedFile file(path, "must be a readable file");
    file.require_stored();
    return std::string(file.bytes());
}

std::string picture_beside(const std::string& path) {
    const fs::path picture = fs::path(path).replace_extension(".png");
    return fs::exists(picture) ? read_bytes(picture.string()) : "";
}

ResultPanel capture_panel(const std::string& path, const core::Capture& capture) {
    ResultPanel panel;
    panel.file = shown_file(path);
    panel.picture_png = nlos::encode_panels(nlos::capture_panels(capture), kCaptureColumns);
    panel.facts = capture_facts(capture);
    panel.notes = capture.notes;
    if (!capture.scene_info->empty()) panel.settings = *capture.scene_info;
    return panel;
}

ResultPanel volume_panel(const std::string& path, const nlos::Reconstruction& result) {
    ResultPanel panel;
    panel.file = shown_file(path);
    panel.picture_png = nlos::encode_panels(nlos::volume_panels(result), kVolumeColumns);
    panel.facts = volume_facts(result);
    panel.settings = core::write_value(result.settings);
    return panel;
}

ResultPanel fit_panel(const std::string& path, const core::Json& json) {
    ResultPanel panel;
    panel.file = shown_file(path);
    panel.facts = fit_facts(calib::read_fit(path), json);
    panel.picture_png = picture_beside(path);
    for (const char* key : {"warnings", "unidentifiable"}) {
        for (const core::Json& text : json.value(key, core::Json::array())) {
            const std::string prefix =
                std::string(key) == "warnings" ? "Warning: " : "Unidentifiable: ";
            panel.notes.push_back(prefix + text.get<std::string>());
        }
    }
    for (const core::Json& pair : json.value("correlations", core::Json::array())) {
        panel.notes.push_back(fmt::format("Correlated: {} with {} ({:.3f})",
                                          pair.value("a", ""),
                                          pair.value("b", ""),
                                          pair.value("value", 0.0)));
    }
    panel.settings = json;
    return panel;
}

ResultPanel track_panel(const std::string& path, const core::Json& json) {
    const std::vector<calib::TrackedFrame> frames = calib::read_track(path);
    ResultPanel panel;
    panel.file = shown_file(path);
    std::size_t named = 0;
    std::size_t most = 0;
    std::vector<double> sigmas_m;
    Eigen::AlignedBox3d box;
    for (const calib::TrackedFrame& frame : frames) {
        named += frame.targets.empty() ? 0 : 1;
        most = std::max(most, frame.targets.size());
        for (const calib::TrackedPosition& target : frame.targets) {
            box.extend(target.position_m);
            if (target.covariance_m2) sigmas_m.push_back(std::sqrt(target.covariance_m2->trace()));
        }
    }
    panel.facts.emplace_back("frames", std::to_string(frames.size()));
    panel.facts.emplace_back(
        "time", fmt::format("{:.2f} to {:.2f} s", frames.front().time_s, frames.back().time_s));
    panel.facts.emplace_back("frames with a target", std::to_string(named));
    panel.facts.emplace_back("targets at a time", fmt::format("at most {}", most));
    if (named > 0) {
        for (const int axis : {0, 1, 2}) {
            panel.facts.emplace_back(
                fmt::format("world {}", "xyz"[axis]),
                fmt::format("{:.2f} to {:.2f} m", box.min()[axis], box.max()[axis]));
        }
    }
    if (!sigmas_m.empty()) {
        panel.facts.emplace_back("reported error, median",
                                 short_number(core::upper_median(sigmas_m)) + " m");
    }
    panel.picture_png = picture_beside(path);
    for (const core::Json& text : json.value("warnings", core::Json::array())) {
        if (text.is_string()) panel.notes.push_back("Warning: " + text.get<std::string>());
    }
    for (const char* key : {"settings", "version", "command"}) {
        if (json.contains(key)) panel.settings[key] = json[key];
    }
    return panel;
}

}  // namespace apps
