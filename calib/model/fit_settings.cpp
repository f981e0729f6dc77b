// SPDX-License-Identifier: MIT
#include "calib/model/fit_settings.h"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>

namespace calib {
namespace {

constexpr const char* kObjectChoices =
    "a list of pose, translation, rotation, size, albedo, vertices";

FreeObject read_object(const core::Json& json, const std::string& where, const std::string& name) {
    FreeObject object;
    object.name = name;
    if (!json.is_array()) core::throw_wrong_type(where, json, kObjectChoices);
    for (const core::Json& item : json) {
        const std::string what = item.is_string() ? item.get<std::string>() : "";
        if (what == "pose") {
            object.translation = object.rotation = true;
        } else if (what == "translation") {
            object.translation = true;
        } else if (what == "rotation") {
            object.rotation = true;
        } else if (what == "size") {
            object.size = true;
        } else if (what == "albedo") {
            object.albedo = true;
        } else if (what == "vertices") {
            object.vertices = true;
        } else {
            core::throw_wrong_type(where, item, kObjectChoices);
        }
    }
    return object;
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

void read_wall(const core::Json& json, const std::string& where, FreeSettings& free) {
    if (!json.is_array()) core::throw_wrong_type(where, json, "a list of bow, scale");
    for (const core::Json& item : json) {
        if (item == "bow") {
            free.wall_bow = true;
        } else if (item == "scale") {
            free.wall_scale = true;
        } else {
            core::throw_wrong_type(where, item, "bow or scale");
        }
    }
}

void require(bool holds,
             const std::string& where,
             const std::string& found,
             const std::string& allowed) {
    if (!holds) throw core::Error(where, "found " + found, allowed);
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
            read_wall(value, place, free);
        } else {
            free.objects.push_back(read_object(value, place, key));
        }
    }
}

core::Json write_value(const FreeSettings& free) {
    core::Json json = core::Json::object();
    for (const FreeObject& object : free.objects) {
        core::Json& list = json[object.name] = core::Json::array();
        if (object.translation) list.push_back("translation");
        if (object.rotation) list.push_back("rotation");
        if (object.size) list.push_back("size");
        if (object.albedo) list.push_back("albedo");
        if (object.vertices) list.push_back("vertices");
    }
    json["point_scatterers"] = free.point_scatterers;
    json["time_zero"] = free.time_zero;
    if (free.time_zero_sigma_m) json["time_zero"] = {{"prior_sigma_m", *free.time_zero_sigma_m}};
    json["ambient"] = free.ambient;
    json["response_fwhm"] = free.response_fwhm;
    json["wall"] = core::Json::array();
    if (free.wall_bow) json["wall"].push_back("bow");
    if (free.wall_scale) json["wall"].push_back("scale");
    return json;
}

void read_value(const core::Json& json, const std::string& where, LossKind& loss) {
    if (json.is_null()) {
        loss = LossKind::None;
        return;
    }
    for (const LossKind kind : {LossKind::None, LossKind::Huber, LossKind::Cauchy}) {
        if (json == core::enum_name(kind)) {
            loss = kind;
            return;
        }
    }
    core::throw_wrong_type(where, json, "null, huber or cauchy");
}

void validate(const FitSettings& s, const std::string& where) {
    require(!s.scene.empty(), where + "scene", "nothing", "must name a scene.json");
    require(s.free.point_scatterers >= 0 && s.free.point_scatterers <= 1000,
            where + "free.point_scatterers",
            std::to_string(s.free.point_scatterers),
            "must be from 0 to 1000");
    if (s.free.time_zero_sigma_m) {
        require(*s.free.time_zero_sigma_m > 0.0,
                where + "free.time_zero.prior_sigma_m",
                fmt::format("{}", *s.free.time_zero_sigma_m),
                "must be positive");
    }
    require(!s.blur_schedule_m.empty() && s.blur_schedule_m.back() == 0.0,
            where + "blur_schedule_m",
            "no 0 at its end",
            "must end in 0, since blurred counts are not Poisson");
    for (const double blur : s.blur_schedule_m) {
        require(std::isfinite(blur) && blur >= 0.0,
                where + "blur_schedule_m",
                fmt::format("{}", blur),
                "must be at least 0");
    }
    const auto positive = [&](double value, const char* key) {
        require(std::isfinite(value) && value > 0.0,
                where + key,
                fmt::format("{}", value),
                "must be positive");
    };
    positive(s.loss_scale, "loss_scale");
    if (s.element_tolerance) positive(*s.element_tolerance, "piece_tolerance");
    if (s.max_pairs) positive(*s.max_pairs, "max_pairs");
    positive(s.max_iterations, "max_iterations");
    positive(s.search_rotations, "search_rotations");
    require(s.laplacian_weight >= 0.0,
            where + "laplacian_weight",
            fmt::format("{}", s.laplacian_weight),
            "must be at least 0");
    if (s.window_m) {
        require((*s.window_m)[0] < (*s.window_m)[1],
                where + "window_m",
                fmt::format("[{}, {}]", (*s.window_m)[0], (*s.window_m)[1]),
                "must grow");
    }
}

FitSettings read_fit_settings(const std::string& path, const std::vector<std::string>& overrides) {
    FitSettings settings;
    core::read_value(core::read_json_file(path), path + ": ", settings);
    for (const std::string& text : overrides) core::apply_override(settings, text);
    validate(settings, path + ": ");
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
