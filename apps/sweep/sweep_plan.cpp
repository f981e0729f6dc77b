// SPDX-License-Identifier: MIT
#include "apps/sweep/sweep_plan.h"

#include "apps/batch/checksum.h"
#include "apps/sweep/sweep_summary.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/scene/load_geometry.h"

#include <fmt/core.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>

namespace apps {
namespace {

using core::Json;

constexpr const char* kScene = "scene";
constexpr const char* kNoise = "noise";
constexpr const char* kReconstruct = "reconstruct";

bool belongs_to(const std::string& key, const std::string& part) {
    return key.starts_with(part + ".");
}

std::string compact(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void check_response(const core::ResponseSettings& response) {
    if (core::is_given(response) && !response.of_capture) core::make_response(response, "response");
}

}  // namespace

SweepPlan::SweepPlan(const std::string& path, const std::vector<std::string>& overrides)
    : path_(path), settings_(read_sweep(path, overrides)) {
    scene_ = renderer::read_scene_description(settings_.scene, {});
    num_runs_ = static_cast<std::size_t>(settings_.repeats);
    for (const SweepAxis& axis : settings_.grid.axes) num_runs_ *= axis.values.size();
    check_parts();
    check_plots(settings_, path_ + ": ");
    take_fingerprint();
}

Json SweepPlan::values_of(std::size_t run) const {
    std::size_t rest = run / static_cast<std::size_t>(settings_.repeats);
    std::vector<std::size_t> indices(settings_.grid.axes.size());
    for (std::size_t i = indices.size(); i-- > 0;) {
        const std::size_t count = settings_.grid.axes[i].values.size();
        indices[i] = rest % count;
        rest /= count;
    }
    Json values = Json::object();
    for (std::size_t i = 0; i < indices.size(); ++i) {
        const SweepAxis& axis = settings_.grid.axes[i];
        for (std::size_t k = 0; k < axis.keys.size(); ++k) {
            values[axis.keys[k]] = axis.values[indices[i]][k];
        }
    }
    return values;
}

SweepRun SweepPlan::run(std::size_t number) const {
    SweepRun run;
    run.number = number;
    run.repeat = static_cast<int>(number % static_cast<std::size_t>(settings_.repeats));
    run.values = values_of(number);
    run.scene = scene_of(run.values);
    run.scene_changes = compact(changes_of(kScene, run.values));
    run.noise = noise_of(run.values);
    if (run.noise) run.noise->seed += static_cast<std::uint64_t>(run.repeat);
    run.noise_changes = fmt::format("{} {}", compact(changes_of(kNoise, run.values)), run.repeat);
    run.reconstruct = reconstruct_of(run.values);
    return run;
}

std::vector<std::vector<std::size_t>> SweepPlan::pieces(std::size_t num_shares) const {
    std::vector<std::vector<std::size_t>> captures;
    std::map<std::string, std::size_t> known;
    for (std::size_t run = 0; run < num_runs_; ++run) {
        const auto [it, is_new] =
            known.try_emplace(compact(changes_of(kScene, values_of(run))), captures.size());
        if (is_new) captures.emplace_back();
        captures[it->second].push_back(run);
    }
    const std::size_t parts = (num_shares + captures.size() - 1) / captures.size();
    std::vector<std::vector<std::size_t>> pieces;
    for (const auto& runs : captures) {
        for (std::size_t part = 0; part < parts; ++part) {
            const std::size_t begin = runs.size() * part / parts;
            const std::size_t end = runs.size() * (part + 1) / parts;
            if (begin == end) continue;
            pieces.emplace_back(runs.begin() + static_cast<std::ptrdiff_t>(begin),
                                runs.begin() + static_cast<std::ptrdiff_t>(end));
        }
    }
    return pieces;
}

Json SweepPlan::changes_of(const char* part, const Json& values) const {
    Json all = Json::object();
    if (const auto it = settings_.fixed.values.find(part); it != settings_.fixed.values.end()) {
        all[part] = *it;
    }
    for (const auto& [key, value] : values.items()) {
        if (belongs_to(key, part)) merge_values(nested_value(key, value), all);
    }
    return all.value(part, Json::object());
}

template <class Body>
auto SweepPlan::read_part(const char* part, const Json& values, const Body& body) const {
    try {
        return body(changes_of(part, values));
    } catch (const core::Error& error) {
        std::string position;  // in the grid, as far as the part's settings depend on it
        for (const auto& [key, value] : values.items()) {
            if (!belongs_to(key, part)) continue;
            position +=
                fmt::format("{}{} = {}", position.empty() ? " where " : ", ", key, compact(value));
        }
        throw core::Error(fmt::format("{}: {}.{}", path_, part, error.where()),
                          error.found() + position,
                          error.allowed());
    }
}

renderer::SceneDescription SweepPlan::scene_of(const Json& values) const {
    return read_part(kScene, values, [&](Json changes) {
        renderer::SceneDescription scene = scene_;
        if (const auto it = changes.find("geometry"); it != changes.end() && it->is_string()) {
            const auto folder = std::filesystem::path(settings_.scene).parent_path();
            *it = (folder / it->get<std::string>()).string();
        }
        renderer::change_description(scene, changes);
        if (!scene.camera) return scene;
        throw core::Error("camera", "found one", "must be left out: depth is seen from a wall");
    });
}

std::optional<nlos::DetectorSettings> SweepPlan::noise_of(const Json& values) const {
    return read_part(
        kNoise, values, [](const Json& changes) -> std::optional<nlos::DetectorSettings> {
            nlos::DetectorSettings noise;
            core::read_value(changes, "", noise);
            check_response(noise.response);
            if (noise.photons || noise.photons_per_point || noise.exposure_s) {
                nlos::validate(noise);
                return noise;
            }
            core::check_ranges(noise, "");
            return std::nullopt;
        });
}

nlos::ReconstructSettings SweepPlan::reconstruct_of(const Json& values) const {
    return read_part(kReconstruct, values, [](const Json& changes) {
        nlos::ReconstructSettings reconstruct;
        core::read_value(changes, "", reconstruct);
        check_response(reconstruct.response);
        nlos::validate(reconstruct);
        return reconstruct;
    });
}

/// Reads the settings of every run, each combination of a part's values once.
void SweepPlan::check_parts() const {
    std::set<std::string> seen;
    const auto is_new = [&](const char* part, const Json& values) {
        return seen.insert(part + compact(changes_of(part, values))).second;
    };
    const auto repeats = static_cast<std::size_t>(settings_.repeats);
    for (std::size_t run = 0; run < num_runs_; run += repeats) {
        const Json values = values_of(run);
        if (is_new(kNoise, values)) noise_of(values);
        if (is_new(kReconstruct, values)) reconstruct_of(values);
        if (!is_new(kScene, values)) continue;
        const renderer::SceneDescription scene = scene_of(values);
        const std::string objects = compact({scene.geometry,
                                             core::write_value(scene.geometry_unit_m),
                                             core::write_value(scene.geometry_up),
                                             core::write_value(scene.objects)});
        if (seen.insert(objects).second) renderer::load_geometry(scene);
    }
}

void SweepPlan::take_fingerprint() {
    std::string checksums;
    const auto add = [&](std::string_view text) { checksums += text_checksum(text); };
    SweepSettings sweep = settings_;
    sweep.scene.clear();  // a folder that is moved stays the same sweep
    sweep.plots.reset();
    add(compact(core::write_value(sweep)));
    add(core::MappedFile(settings_.scene).bytes());
    std::set<std::string> files;
    const auto add_file = [&](const std::string& path) {
        if (!path.empty() && files.insert(path).second) add(core::MappedFile(path).bytes());
    };
    const auto repeats = static_cast<std::size_t>(settings_.repeats);
    for (std::size_t number = 0; number < num_runs_; number += repeats) {
        const Json values = values_of(number);
        const Json scene = changes_of(kScene, values);
        const bool is_changed = scene.contains("geometry") || scene.contains("objects");
        for (const auto& path : renderer::geometry_files(is_changed ? scene_of(values) : scene_)) {
            add_file(path);
        }
        for (const char* part : {kNoise, kReconstruct}) {
            const Json response = changes_of(part, values).value("response", Json::object());
            if (response.is_object()) add_file(response.value("curve", ""));
        }
    }
    fingerprint_ = text_checksum(checksums);
}

}  // namespace apps
