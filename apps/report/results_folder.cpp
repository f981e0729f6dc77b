// SPDX-License-Identifier: MIT
#include "apps/report/results_folder.h"

#include "apps/file_kind.h"
#include "calib/fit_file.h"
#include "calib/track/track_file.h"
#include "nlos/formats/volume_file.h"
#include "renderer/core/settings/settings_json.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace apps {
namespace {

namespace fs = std::filesystem;

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
    scored.file = shown_file(path);
    scored.name = shown_name(fs::path(scored.file).stem().string());
    scored.result = file_name_at(json, "result");
    scored.reference = file_name_at(json, "reference");
    if (!scored.reference.empty()) scored.reference_path = json["reference"].get<std::string>();
    for_each_field(scored.metrics, [&](const char* name, auto& field, const char*) {
        const auto it = json.find(name);
        if (it != json.end()) core::read_value(*it, path.string() + ": " + name, field);
    });
    scored.picture_png = picture_beside(path.string());
    return scored;
}

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
    static const std::set<std::string> suffixes{
        ".h5", ".hdf5", ".mat", ".exr", ".npz", ".npy", ".ti"};
    return suffixes.contains(suffix);
}

void read_measurement(const fs::path& path,
                      const nlos::CaptureReadSettings& settings,
                      ResultsFolder& results) {
    const std::string name = shown_file(path);
    if (nlos::is_volume_file(path.string())) {
        const nlos::Reconstruction volume = nlos::read_volume(path.string());
        results.volumes.push_back(volume_panel(path.string(), volume));
        results.views.results.push_back(result_view(volume, name));
        return;
    }
    const core::Capture capture = nlos::read_capture(path.string(), settings);
    results.captures.push_back(capture_panel(path.string(), capture));
    results.views.animations.push_back(animation_view(capture, name));
    const auto* points = capture.scan.as<core::WallScan>();
    if (!results.views.scan && points != nullptr) results.views.scan = *points;
}

void read_json(const fs::path& path, ResultsFolder& results) {
    const std::string name = shown_file(path);
    core::Json json = core::read_json_file(path.string());
    if (is_metrics(json)) {
        results.scores.push_back(scored_result(path, json));
    } else if (calib::is_fit_file(path.string())) {
        results.fits.push_back(fit_panel(path.string(), json));
    } else if (calib::is_track(json) && json.contains("track_of")) {
        results.tracks.push_back(track_panel(path.string(), json));
    } else if (is_bench(json)) {
        results.benches.push_back(read_bench_panel(path.string(), json));
    } else if (is_sweep(json)) {
        results.sweeps.push_back({name, std::move(json), {}});
    } else if (json.contains("hard_cases")) {
        results.hard_cases = json["hard_cases"];
    } else if (!is_collection_of_benches(json)) {
        results.documents.push_back({name, std::move(json)});
    }
}

/// Reads a file of a folder; what is nothing of a result is passed over.
void read_file(const fs::path& path, ResultsFolder& results) {
    const std::string suffix = path.extension().string();
    if (is_measurement(suffix)) {
        read_measurement(path, {}, results);
    } else if (suffix == ".json") {
        read_json(path, results);
    } else if (suffix == ".png" || suffix == ".svg") {
        results.figures.push_back({shown_file(path), read_bytes(path.string())});
    }
}

/// A message without the folder before file names: a page should not tell where it was made.
std::string without_folder(std::string message, const fs::path& folder) {
    const std::string prefix = core::printable((folder / "").string());
    for (auto at = message.find(prefix); at != std::string::npos; at = message.find(prefix)) {
        message.erase(at, prefix.size());
    }
    return message;
}

/// Drops pictures that belong to a file shown with a picture of its own.
void drop_accompanying_figures(ResultsFolder& results) {
    std::set<std::string> stems;
    const auto add = [&](const std::string& file) { stems.insert(fs::path(file).stem().string()); };
    for (const auto* panels :
         {&results.captures, &results.volumes, &results.fits, &results.tracks}) {
        for (const ResultPanel& panel : *panels) add(panel.file);
    }
    for (const ScoredResult& scored : results.scores) add(scored.file);
    std::erase_if(results.figures, [&](const Figure& figure) {
        const fs::path file = figure.file;
        return file.extension() == ".png" && stems.contains(file.stem().string());
    });
}

/// Paths of scenes that the results name: what metrics are against, what captures were rendered
/// from.
std::vector<std::string> named_scenes(const ResultsFolder& results) {
    std::vector<std::string> paths;
    for (const ScoredResult& scored : results.scores) paths.push_back(scored.reference_path);
    for (const ResultPanel& capture : results.captures) {
        if (!capture.settings.is_object()) continue;
        const auto scene = capture.settings.find("scene");
        if (scene != capture.settings.end() && scene->is_string()) paths.push_back(*scene);
    }
    return paths;
}

/// The truth of the first named scene that is still there and can be looked at from its wall.
void find_truth(const fs::path& folder, ResultsFolder& results) {
    for (const std::string& name : named_scenes(results)) {
        for (const fs::path& path : {fs::path(name), folder / name}) {
            try {
                if (kind_of_file(path.string()) != FileKind::Scene) continue;
                results.views.truth = truth_view(path.string(), results.views.results);
                return;
            } catch (const std::exception&) {
                continue;  // gone, moved or changed since: the page does without
            }
        }
    }
}

/// The result with the highest F-score, or else the first.
std::size_t best_result(const ResultsFolder& results) {
    std::size_t best = 0;
    double highest = -1.0;
    for (const ScoredResult& scored : results.scores) {
        for (std::size_t i = 0; i < results.volumes.size(); ++i) {
            const double fscore = scored.metrics.fscore_10mm.value_or(-1.0);
            if (results.volumes[i].file != scored.result || fscore <= highest) continue;
            highest = fscore;
            best = i;
        }
    }
    return best;
}

constexpr std::size_t kMostSettings = 2;  // in a label

/// The settings of a result by their paths: `volume.voxels.0`.
std::map<std::string, std::string> settings_of(const ResultPanel& panel) {
    std::map<std::string, std::string> settings;
    if (!panel.settings.is_structured()) return settings;
    const core::Json flat = panel.settings.flatten();
    for (const auto& [pointer, value] : flat.items()) {
        std::string path = pointer.substr(1);
        std::replace(path.begin(), path.end(), '/', '.');
        settings[path] = value.is_string() ? value.get<std::string>() : value.dump();
    }
    return settings;
}

/// The settings that differ between some of the panels.
std::vector<std::string> differing(const std::vector<ResultPanel*>& panels) {
    std::map<std::string, std::map<std::string, std::size_t>> values;
    for (const ResultPanel* panel : panels) {
        for (const auto& [path, value] : settings_of(*panel)) ++values[path][value];
    }
    std::vector<std::string> paths;
    for (const auto& [path, counts] : values) {
        const bool same = counts.size() == 1 && counts.begin()->second == panels.size();
        if (!same && paths.size() < kMostSettings) paths.push_back(path);
    }
    return paths;
}

void tell_apart(const std::vector<ResultPanel*>& panels) {
    const std::vector<std::string> paths = differing(panels);
    std::map<std::string, std::size_t> count;
    for (ResultPanel* panel : panels) {
        const std::map<std::string, std::string> settings = settings_of(*panel);
        for (const std::string& path : paths) {
            const auto found = settings.find(path);
            if (found != settings.end()) panel->label += ", " + path + " " + found->second;
        }
        ++count[panel->label];
    }
    for (ResultPanel* panel : panels) {
        if (count[panel->label] == 1) continue;
        panel->label += ", " + fs::path(panel->file).stem().string();
    }
}

/// What only the whole says: labels, whose pictures are whose, the truth.
void complete(const fs::path& folder, const std::string& scene, ResultsFolder& results) {
    label_by_method(results);
    results.views.best = best_result(results);
    drop_accompanying_figures(results);
    give_figures_to_benches(results.figures, results.benches);
    give_figures_to_sweeps(results.figures, results.sweeps);
    if (scene.empty()) {
        find_truth(folder, results);
    } else {
        results.views.truth = truth_view(scene, results.views.results);
    }
}

}  // namespace

void label_by_method(ResultsFolder& results) {
    std::map<std::string, std::vector<ResultPanel*>> of_method;
    for (std::size_t i = 0; i < results.volumes.size(); ++i) {
        ResultPanel& panel = results.volumes[i];
        panel.label = results.views.results[i].name;
        if (!panel.label.empty()) of_method[panel.label].push_back(&panel);
    }
    for (const auto& [method, panels] : of_method) {
        if (panels.size() > 1) tell_apart(panels);
    }
    for (std::size_t i = 0; i < results.volumes.size(); ++i) {
        const ResultPanel& panel = results.volumes[i];
        results.views.results[i].name = panel.label.empty() ? panel.file : panel.label;
        for (ScoredResult& scored : results.scores) {
            if (scored.result == panel.file && !panel.label.empty()) scored.name = panel.label;
        }
    }
}

ResultsFolder read_results_folder(const std::string& folder, const std::string& scene) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) {
        throw core::Error(folder, "is not a folder", "must be a folder of results");
    }
    ResultsFolder results;
    results.name = shown_file(fs::canonical(folder));
    if (is_dataset(folder)) results.dataset = dataset_panel(folder);
    for (const fs::path& path : visible_files(folder)) {
        if (results.dataset && belongs_to_dataset(path.filename().string())) continue;
        try {
            read_file(path, results);
        } catch (const std::exception& failure) {
            results.unreadable.push_back(
                {shown_file(path), without_folder(failure.what(), folder)});
        }
    }
    complete(folder, scene, results);
    if (results.empty()) {
        throw core::Error(folder,
                          "holds no result",
                          "must hold captures or volumes (.h5), metrics (.json) or pictures");
    }
    return results;
}

ResultsFolder read_result_files(const std::vector<std::string>& paths,
                                const nlos::CaptureReadSettings& settings) {
    ResultsFolder results;
    std::string scene;
    for (const std::string& path : paths) {
        const FileKind kind = kind_of_file(path);
        const fs::path file = path;
        if (kind == FileKind::Scene) {
            scene = path;
        } else if (kind == FileKind::Capture || kind == FileKind::Volume) {
            read_measurement(file, settings, results);
        } else if (file.extension() == ".json") {
            read_json(file, results);
        } else {
            throw core::Error(
                path, "is a shape", "must be a capture, volume, scene.json or result in JSON");
        }
        results.name += (results.name.empty() ? "" : ", ") + shown_file(file);
    }
    complete(fs::path(paths.front()).parent_path(), scene, results);
    return results;
}

}  // namespace apps
