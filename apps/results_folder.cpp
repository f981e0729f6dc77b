// SPDX-License-Identifier: MIT
#include "apps/results_folder.h"

#include "apps/bench/card.h"
#include "calib/fit_file.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/pictures.h"
#include "nlos/wall_frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace apps {
namespace {

namespace fs = std::filesystem;

constexpr int kCaptureColumns = 3;
constexpr int kVolumeColumns = 2;

std::string read_bytes(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw core::Error(path.string(), "cannot be opened", "must be a readable file");
    std::ostringstream bytes;
    bytes << file.rdbuf();
    return bytes.str();
}

std::string range_text(double low, double high, const std::string& unit) {
    return fmt::format("{} to {} {}", short_number(low), short_number(high), unit);
}

std::string megabytes(double bytes) {
    return short_number(bytes / 1e6) + " MB";
}

// ---- Captures ----------------------------------------------------------------------------------

std::string points_text(const core::WallPoints& points) {
    if (!points.grid) return fmt::format("{} (list)", points.size());
    return fmt::format("{} x {}", (*points.grid)[0], (*points.grid)[1]);
}

std::vector<Fact> scan_facts(const core::Scan& scan) {
    if (scan.camera) {
        return {
            {"Camera", fmt::format("{} x {} pixels", scan.camera->width(), scan.camera->height())},
            {"Angle of view", short_number(scan.camera->fov_y_deg) + " degrees high"},
            {"Light", scan.camera->light_spot_m ? "spot on a surface" : "point"}};
    }
    const nlos::WallFrame frame = nlos::derive_wall_frame(scan);
    std::vector<Fact> facts{{"Scan", std::string(core::enum_name(scan.pattern))},
                            {"Sensing points", points_text(scan.sensing)}};
    if (scan.pattern != core::ScanPattern::Confocal) {
        facts.emplace_back("Illumination points", points_text(scan.illumination));
    }
    facts.emplace_back("Wall covered",
                       fmt::format("{} x {} m",
                                   short_number(frame.max_m[0] - frame.min_m[0]),
                                   short_number(frame.max_m[1] - frame.min_m[1])));
    return facts;
}

std::string path_origin(const core::Scan& scan) {
    if (scan.camera) return "the light";
    return scan.opl_origin == core::OplOrigin::Device ? "the device" : "the relay wall";
}

std::vector<Fact> capture_facts(const core::Capture& capture) {
    const core::TimeAxis& axis = capture.time_axis;
    const auto values = capture.transient.values();
    double total = 0.0;
    for (const float value : values) total += value;
    std::vector<Fact> facts = scan_facts(capture.scan);
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
         {"Unit", std::string(core::enum_name(capture.unit))},
         {"Largest value", short_number(*std::max_element(values.begin(), values.end()))},
         {"Sum of all values", short_number(total)}});
    return facts;
}

ResultCard capture_card(const fs::path& path) {
    const core::Capture capture = nlos::read_capture(path.string());
    ResultCard card;
    card.file = path.filename().string();
    card.picture_png = nlos::encode_panels_png(nlos::capture_panels(capture), kCaptureColumns);
    card.facts = capture_facts(capture);
    card.notes = capture.notes;
    if (!capture.scene_info.empty()) card.settings = capture.scene_info;
    return card;
}

// ---- Volumes -----------------------------------------------------------------------------------

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
        facts.emplace_back("Peak memory", megabytes(static_cast<double>(result.peak_bytes)));
    }
    return facts;
}

ResultCard volume_card(const fs::path& path) {
    const nlos::Reconstruction result = nlos::read_volume(path.string());
    ResultCard card;
    card.file = path.filename().string();
    card.picture_png = nlos::encode_panels_png(nlos::volume_panels(result), kVolumeColumns);
    card.facts = volume_facts(result);
    card.settings = core::write_value(result.settings);
    return card;
}

// ---- Fits --------------------------------------------------------------------------------------

std::string with_sigma(double value, double sigma, double unit, const std::string& name) {
    const std::string text = short_number(unit * value);
    if (sigma == calib::kFixed) return text + name;
    if (!std::isfinite(sigma)) return text + name + " (unknown)";
    return text + " +- " + short_number(unit * sigma) + name;
}

std::string place_text(const core::Vec3& position_m, const core::Vec3& sigma_m) {
    std::string text;
    for (int a = 0; a < 3; ++a) {
        text += (a == 0 ? "" : ", ") + with_sigma(position_m[a], sigma_m[a], 1e3, "");
    }
    return "(" + text + ") mm";
}

std::vector<Fact> fit_facts(const calib::FitResult& fit, const core::Json& json) {
    std::vector<Fact> facts;
    for (const calib::FittedObject& object : fit.objects) {
        std::string text = place_text(object.position_m, object.position_sigma_m);
        if (object.rotation_sigma_deg.norm() > 0.0) {
            text += ", turned +- " + short_number(object.rotation_sigma_deg.norm()) + " deg";
        }
        text += ", size " + with_sigma(object.size, object.size_sigma, 1.0, "") + ", albedo " +
                with_sigma(object.albedo, object.albedo_sigma, 1.0, "");
        facts.emplace_back(object.name, text);
    }
    for (std::size_t i = 0; i < fit.points.size(); ++i) {
        facts.emplace_back(fmt::format("Point {}", i),
                           place_text(fit.points[i].position_m, fit.points[i].position_sigma_m));
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

ResultCard fit_card(const fs::path& path, const core::Json& json) {
    ResultCard card;
    card.file = path.filename().string();
    card.facts = fit_facts(calib::read_fit(path.string()), json);
    const fs::path picture = fs::path(path).replace_extension(".png");
    if (fs::exists(picture)) card.picture_png = read_bytes(picture);
    for (const char* key : {"warnings", "unidentifiable"}) {
        for (const core::Json& text : json.value(key, core::Json::array())) {
            const std::string prefix =
                std::string(key) == "warnings" ? "Warning: " : "Unidentifiable: ";
            card.notes.push_back(prefix + text.get<std::string>());
        }
    }
    for (const core::Json& pair : json.value("correlations", core::Json::array())) {
        card.notes.push_back(fmt::format("Correlated: {} with {} ({:.3f})",
                                         pair.value("a", ""),
                                         pair.value("b", ""),
                                         pair.value("value", 0.0)));
    }
    card.settings = json;
    return card;
}

// ---- JSON --------------------------------------------------------------------------------------

bool is_metrics(const core::Json& json) {
    return json.is_object() && json.contains("depth_mae_m") && json.contains("mask_iou") &&
           json.contains("rel_l2");
}

std::string file_name_at(const core::Json& json, const char* key) {
    const auto it = json.find(key);
    if (it == json.end() || !it->is_string()) return "";
    return fs::path(it->get<std::string>()).filename().string();
}

std::string shown_name(const std::string& stem) {
    constexpr std::string_view kPrefix = "metrics_";
    const bool has_more = stem.starts_with(kPrefix) && stem.size() > kPrefix.size();
    return has_more ? stem.substr(kPrefix.size()) : stem;
}

ScoredResult scored_result(const fs::path& path, const core::Json& json) {
    ScoredResult scored;
    scored.file = path.filename().string();
    scored.name = shown_name(path.stem().string());
    scored.result = file_name_at(json, "result");
    scored.reference = file_name_at(json, "reference");
    for_each_field(scored.metrics, [&](const char* name, auto& field, const char*) {
        const auto it = json.find(name);
        if (it != json.end()) core::read_value(*it, path.string() + ": " + name, field);
    });
    const fs::path picture = fs::path(path).replace_extension(".png");
    if (fs::exists(picture)) scored.picture_png = read_bytes(picture);
    return scored;
}

// ---- The folder --------------------------------------------------------------------------------

/// Regular files in the order of their names; names that begin with a dot are temporary files.
std::vector<fs::path> visible_files(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const bool hidden = entry.path().filename().string().starts_with('.');
        if (entry.is_regular_file() && !hidden) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

bool is_measurement(const std::string& suffix) {
    return suffix == ".h5" || suffix == ".hdf5" || suffix == ".mat" || suffix == ".exr";
}

void read_file(const fs::path& path, ResultsFolder& results) {
    const std::string suffix = path.extension().string();
    const std::string name = path.filename().string();
    if (is_measurement(suffix)) {
        if (nlos::is_volume_file(path.string())) {
            results.volumes.push_back(volume_card(path));
        } else {
            results.captures.push_back(capture_card(path));
        }
    } else if (suffix == ".json") {
        core::Json json = core::read_json_file(path.string());
        if (is_metrics(json)) {
            results.scores.push_back(scored_result(path, json));
        } else if (calib::is_fit_file(path.string())) {
            results.fits.push_back(fit_card(path, json));
        } else if (is_bench(json)) {
            results.benches.push_back(read_bench_card(path.string(), json));
        } else if (json.contains("hard_cases")) {
            results.hard_cases = json["hard_cases"];
        } else if (!is_collection_of_benches(json)) {
            results.documents.push_back({name, std::move(json)});
        }
    } else if (suffix == ".png" || suffix == ".svg") {
        const std::string mime_type = suffix == ".png" ? "image/png" : "image/svg+xml";
        results.figures.push_back({name, mime_type, read_bytes(path)});
    }
}

/// A message without the folder before file names: a page should not tell where it was made.
std::string without_folder(std::string message, const fs::path& folder) {
    const std::string prefix = (folder / "").string();
    for (auto at = message.find(prefix); at != std::string::npos; at = message.find(prefix)) {
        message.erase(at, prefix.size());
    }
    return message;
}

/// Drops pictures that belong to a file shown with a picture of its own.
void drop_accompanying_figures(ResultsFolder& results) {
    std::set<std::string> stems;
    const auto add = [&](const std::string& file) { stems.insert(fs::path(file).stem().string()); };
    for (const ResultCard& card : results.captures) add(card.file);
    for (const ResultCard& card : results.volumes) add(card.file);
    for (const ResultCard& card : results.fits) add(card.file);
    for (const ScoredResult& scored : results.scores) add(scored.file);
    std::erase_if(results.figures, [&](const Figure& figure) {
        const fs::path file = figure.file;
        return file.extension() == ".png" && stems.contains(file.stem().string());
    });
}

}  // namespace

std::string short_number(double value) {
    const double size = std::abs(value);
    if (size == 0.0) return "0";
    if (size < 1e-3 || size >= 1e6) return fmt::format("{:.2e}", value);
    if (size >= 100.0) return fmt::format("{:.0f}", value);
    return fmt::format("{:.3g}", value);
}

ResultsFolder read_results_folder(const std::string& folder) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) {
        throw core::Error(folder, "is not a folder", "must be a folder of results");
    }
    ResultsFolder results;
    results.name = fs::canonical(folder).filename().string();
    for (const fs::path& path : visible_files(folder)) {
        try {
            read_file(path, results);
        } catch (const std::exception& failure) {
            results.unreadable.emplace_back(path.filename().string(),
                                            without_folder(failure.what(), folder));
        }
    }
    drop_accompanying_figures(results);
    give_figures_to_benches(results);
    if (results.empty()) {
        throw core::Error(folder,
                          "holds no result",
                          "must hold captures or volumes (.h5), metrics (.json) or pictures");
    }
    return results;
}

}  // namespace apps
