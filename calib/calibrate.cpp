// SPDX-License-Identifier: MIT
#include "calib/calibrate.h"

#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <filesystem>

namespace calib {

void validate(const SetupSettings& settings, const std::string& where) {
    core::check_ranges(settings, where);
    if (settings.boards) core::check_ranges(*settings.boards, core::join_key(where, "boards"));
    KnownSettings known = settings.known;
    for_each_field(known, [&](const std::string& name, const auto& value, const char*) {
        if (value) core::check_ranges(*value, core::join_key(where, "known." + name));
    });
}

SetupSettings read_setup(const std::string& path, const std::vector<std::string>& overrides) {
    SetupSettings settings;
    core::read_value(core::read_json_file(path), path + ": ", settings);
    for (const std::string& text : overrides) core::apply_override(settings, text);
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    if (settings.direct_returns.empty()) {
        throw core::Error(path + ": direct_returns", "found nothing", "must name a capture");
    }
    settings.direct_returns = (folder / settings.direct_returns).string();
    if (settings.boards && settings.boards->images.empty()) settings.boards.reset();
    if (settings.boards) {
        for (std::string& image : settings.boards->images) image = (folder / image).string();
    }
    validate(settings, path + ": ");
    return settings;
}

Calibration calibrate(const SetupSettings& settings, const core::Capture& capture) {
    validate(settings, "");
    const std::size_t count = capture.transient.num_pairs();
    const auto require_count = [&](std::size_t found, const std::string& key) {
        if (found == count) return;
        throw core::Error(key,
                          fmt::format("found {}", found),
                          fmt::format("must be {}, one per histogram of direct_returns", count));
    };
    require_count(settings.commands.size(), "commands");
    if (settings.boards.has_value() != !settings.spots_px.empty()) {
        throw core::Error("boards and spots_px", "found one of them", "a camera needs both");
    }
    SetupObservations observations;
    Calibration result;
    if (settings.boards) {
        require_count(settings.spots_px.size(), "spots_px");
        result.camera = calibrate_camera(*settings.boards);
        observations.camera = result.camera;
        for (const auto& [x, y] : settings.spots_px) observations.spots_px.emplace_back(x, y);
    }
    result.direct = fit_direct_returns(capture, settings.response);
    observations.returns = result.direct.points;
    observations.axis = capture.time_axis;
    observations.commands = settings.commands;
    observations.command_unit = settings.command_unit;
    observations.spot_sigma_px = settings.spot_sigma_px;
    observations.wall_distance_m = settings.known.wall_distance_m;
    observations.galvo_gain = settings.known.galvo_gain;
    observations.time_zero_m = settings.known.time_zero_m;
    result.setup = solve_setup(observations, settings.outliers);
    return result;
}

std::vector<std::string> Calibration::warnings() const {
    std::vector<std::string> all = direct.warnings;
    all.insert(all.end(), setup.verdict.warnings.begin(), setup.verdict.warnings.end());
    return all;
}

}  // namespace calib
