// SPDX-License-Identifier: MIT
#include "calib/model/fit_settings.h"

#include "renderer/core/settings_json.h"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>

namespace calib {
namespace {

template <class Settings>
struct Flag {
    const char* name;
    bool Settings::*member;
};

// What may be free of an object. `pose` stands for two others and is never written.
constexpr std::array<Flag<FreeObject>, 7> kObjectFlags{{{"pose", &FreeObject::translation},
                                                        {"pose", &FreeObject::rotation},
                                                        {"translation", &FreeObject::translation},
                                                        {"rotation", &FreeObject::rotation},
                                                        {"size", &FreeObject::size},
                                                        {"albedo", &FreeObject::albedo},
                                                        {"vertices", &FreeObject::vertices}}};
constexpr const char* kObjectChoices =
    "a list of pose, translation, rotation, size, albedo, vertices";

constexpr std::array<Flag<FreeSettings>, 2> kWallFlags{
    {{"bow", &FreeSettings::wall_bow}, {"scale", &FreeSettings::wall_scale}}};

// Sets the flags that a list names.
//
// list_choices, item_choices   what a list and its items must be, for the errors
template <class Settings, std::size_t N>
void read_flags(const core::Json& json,
                const std::string& where,
                const std::array<Flag<Settings>, N>& flags,
                const char* list_choices,
                const char* item_choices,
                Settings& settings) {
    if (!json.is_array()) core::throw_wrong_type(where, json, list_choices);
    for (const core::Json& item : json) {
        bool is_known = false;
        for (const Flag<Settings>& flag : flags) {
            if (item != flag.name) continue;
            settings.*flag.member = is_known = true;
        }
        if (!is_known) core::throw_wrong_type(where, item, item_choices);
    }
}

template <class Settings, std::size_t N>
core::Json write_flags(const Settings& settings, const std::array<Flag<Settings>, N>& flags) {
    core::Json json = core::Json::array();
    for (const Flag<Settings>& flag : flags) {
        if (settings.*flag.member && flag.name != std::string_view("pose")) {
            json.push_back(flag.name);
        }
    }
    return json;
}

void read_time_zero(const core::Json& json, const std::string& where, FreeSettings& free) {
    if (json.is_boolean()) {
        free.time_zero = json.get<bool>();
        return;
    }
    if (!json.is_object()) core::throw_wrong_type(where, json, "false, true or { prior_sigma_m }");
    core::check_keys(json, where, {"prior_sigma_m"});
    free.time_zero = true;
    if (json.contains("prior_sigma_m")) {
        core::read_value(json["prior_sigma_m"], where + ".prior_sigma_m", free.time_zero_sigma_m);
    }
}

}  // namespace

void read_value(const core::Json& json, const std::string& where, FreeSettings& free) {
    if (!json.is_object()) core::throw_wrong_type(where, json, "an object with named fields");
    for (const auto& [key, value] : json.items()) {
        const std::string place = core::join_key(where, key);
        if (key == "point_scatterers") {
            core::read_value(value, place, free.point_scatterers);
        } else if (key == "time_zero") {
            read_time_zero(value, place, free);
        } else if (key == "ambient") {
            core::read_value(value, place, free.ambient);
        } else if (key == "response_fwhm") {
            core::read_value(value, place, free.response_fwhm);
        } else if (key == "wall") {
            read_flags(value, place, kWallFlags, "a list of bow, scale", "bow or scale", free);
        } else {
            FreeObject& object = free.objects.emplace_back();
            object.name = key;
            read_flags(value, place, kObjectFlags, kObjectChoices, kObjectChoices, object);
        }
    }
}

core::Json write_value(const FreeSettings& free) {
    core::Json json = core::Json::object();
    for (const FreeObject& object : free.objects) {
        json[object.name] = write_flags(object, kObjectFlags);
    }
    json["point_scatterers"] = free.point_scatterers;
    json["time_zero"] = free.time_zero;
    if (free.time_zero_sigma_m) json["time_zero"] = {{"prior_sigma_m", *free.time_zero_sigma_m}};
    json["ambient"] = free.ambient;
    json["response_fwhm"] = free.response_fwhm;
    json["wall"] = write_flags(free, kWallFlags);
    return json;
}

void read_value(const core::Json& json, const std::string& where, LossKind& loss) {
    for (const auto& [kind, name] : core::EnumNames<LossKind>::value) {
        if (json != name && !(json.is_null() && kind == LossKind::None)) continue;
        loss = kind;
        return;
    }
    core::throw_wrong_type(where, json, "null, huber or cauchy");
}

void validate(const FitSettings& s, const std::string& where) {
    const auto require = [&](bool holds, const char* key, const auto& found, const char* allowed) {
        if (!holds) throw core::Error(where + key, fmt::format("found {}", found), allowed);
    };
    const auto positive = [&](double value, const char* key) {
        require(std::isfinite(value) && value > 0.0, key, value, "must be positive");
    };
    require(s.free.point_scatterers >= 0 && s.free.point_scatterers <= 1000,
            "free.point_scatterers",
            s.free.point_scatterers,
            "must be from 0 to 1000");
    if (s.free.time_zero_sigma_m) {
        positive(*s.free.time_zero_sigma_m, "free.time_zero.prior_sigma_m");
    }
    require(!s.blur_schedule_m.empty() && s.blur_schedule_m.back() == 0.0,
            "blur_schedule_m",
            "no 0 at its end",
            "must end in 0, since blurred counts are not Poisson");
    for (const double blur : s.blur_schedule_m) {
        require(std::isfinite(blur) && blur >= 0.0, "blur_schedule_m", blur, "must be at least 0");
    }
    positive(s.loss_scale, "loss_scale");
    if (s.element_tolerance) positive(*s.element_tolerance, "piece_tolerance");
    if (s.max_pairs) positive(*s.max_pairs, "max_pairs");
    positive(s.max_iterations, "max_iterations");
    positive(s.search_rotations, "search_rotations");
    require(
        s.laplacian_weight >= 0.0, "laplacian_weight", s.laplacian_weight, "must be at least 0");
    if (s.window_m) {
        const auto [begin, end] = *s.window_m;
        require(begin < end, "window_m", fmt::format("[{}, {}]", begin, end), "must grow");
    }
}

FitSettings read_fit_settings(const std::string& path, const std::vector<std::string>& overrides) {
    FitSettings settings;
    core::read_value(core::read_json_file(path), path + ": ", settings);
    for (const std::string& text : overrides) core::apply_override(settings, text);
    validate(settings, path + ": ");
    if (settings.scene.empty()) {
        throw core::Error(path + ": scene", "found nothing", "must name a scene.json");
    }
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    settings.scene = (folder / settings.scene).string();
    if (!settings.response.curve.empty()) {
        settings.response.curve = (folder / settings.response.curve).string();
    }
    if (settings.start != "given" && settings.start != "search") {
        settings.start = (folder / settings.start).string();
    }
    return settings;
}

}  // namespace calib
