// SPDX-License-Identifier: MIT
#include "calib/model/fit_settings.h"

#include "calib/model/parameter.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace calib {
namespace {

// "wall.bow" stands as bow in the list wall.
std::string key_of(const Parameter& row) {
    const std::string name = row.name;
    return name.substr(0, name.find('.'));
}

bool is_listed(const Parameter& row) {
    return key_of(row) != row.name;
}

std::vector<std::string> names_in_list(const std::string& list) {
    std::vector<std::string> names;
    for (const Parameter* row : parameters()) {
        if (is_listed(*row) && key_of(*row) == list) names.push_back(row->name + list.size() + 1);
    }
    return names;
}

void require_known(const core::Json& name,
                   const std::string& where,
                   const std::vector<std::string>& known) {
    if (std::find(known.begin(), known.end(), name) != known.end()) return;
    core::throw_wrong_type(where, name, fmt::format("a list of {}", fmt::join(known, ", ")));
}

// Adds the names that a list holds, with a prefix.
void read_names(const core::Json& json,
                const std::string& where,
                const std::vector<std::string>& known,
                const std::string& prefix,
                std::set<std::string>& names) {
    if (!json.is_array()) require_known(json, where, known);
    for (const core::Json& item : json) {
        require_known(item, where, known);
        names.insert(prefix + item.get<std::string>());
    }
}

// False, true or the parameter's prior.
void read_flag(const Parameter& row,
               const core::Json& json,
               const std::string& where,
               FreeSettings& free) {
    bool is_free = true;
    if (row.prior == nullptr || json.is_boolean()) {
        core::read_value(json, where, is_free);
    } else if (json.is_object()) {
        core::check_keys(json, where, {row.prior});
        if (json.contains(row.prior)) {
            core::read_value(
                json[row.prior], core::join_key(where, row.prior), free.prior_sigma[row.name]);
        }
    } else {
        core::throw_wrong_type(where, json, fmt::format("false, true or {{ {} }}", row.prior));
    }
    if (is_free) {
        free.parameters.insert(row.name);
    } else {
        free.parameters.erase(row.name);
    }
}

FreeObject& object_of_name(const std::string& name, FreeSettings& free) {
    for (FreeObject& object : free.objects) {
        if (object.name == name) return object;
    }
    return free.objects.emplace_back(FreeObject{name, {}});
}

}  // namespace

bool FreeObject::frees(const Parameter& row) const {
    return row.owner == Owner::Body && (parameters.contains(row.name) ||
                                        (row.group != nullptr && parameters.contains(row.group)));
}

std::vector<std::string> free_names(Owner owner) {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    for (const Parameter* row : parameters()) {
        if (row->owner != owner || !row->is_setting) continue;
        if (row->group != nullptr) add(row->group);
        add(key_of(*row));
    }
    return names;
}

const char* free_help() {
    static const std::string kHelp = fmt::format("node name -> any of {}; point_scatterers, {}",
                                                 fmt::join(free_names(Owner::Body), "|"),
                                                 fmt::join(free_names(Owner::Scene), ", "));
    return kHelp.c_str();
}

void read_value(const core::Json& json, const std::string& where, FreeSettings& free) {
    if (!json.is_object()) core::throw_wrong_type(where, json, "an object with named fields");
    for (const auto& [key, value] : json.items()) {
        const std::string key_path = core::join_key(where, key);
        const auto row =
            std::find_if(parameters().begin(), parameters().end(), [&](const Parameter* p) {
                return p->owner == Owner::Scene && p->is_setting && key_of(*p) == key;
            });
        if (key == "point_scatterers") {
            core::read_value(value, key_path, free.point_scatterers);
        } else if (row == parameters().end()) {
            std::set<std::string>& names = object_of_name(key, free).parameters;
            read_names(value, key_path, free_names(Owner::Body), "", names);
        } else if (is_listed(**row)) {
            read_names(value, key_path, names_in_list(key), key + ".", free.parameters);
        } else {
            read_flag(**row, value, key_path, free);
        }
    }
}

core::Json write_value(const FreeSettings& free) {
    core::Json json = core::Json::object();
    for (const FreeObject& object : free.objects) {
        core::Json& names = json[object.name] = core::Json::array();
        for (const Parameter* row : parameters()) {
            if (object.frees(*row)) names.push_back(row->name);
        }
    }
    json["point_scatterers"] = free.point_scatterers;
    for (const Parameter* row : parameters()) {
        if (row->owner != Owner::Scene || !row->is_setting) continue;
        const bool is_free = free.parameters.contains(row->name);
        core::Json& target = json[key_of(*row)];
        const auto prior = free.prior_sigma.find(row->name);
        if (!is_listed(*row)) {
            target = is_free;
            if (prior != free.prior_sigma.end()) target = {{row->prior, prior->second}};
        } else {
            if (target.is_null()) target = core::Json::array();
            if (is_free) target.push_back(row->name + key_of(*row).size() + 1);
        }
    }
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
    core::check_ranges(s, where);
    const auto key = [&](const std::string& name) { return core::join_key(where, name); };
    core::check_range(s.free.point_scatterers, {0, true, 1000, true}, key("free.point_scatterers"));
    std::vector<std::string> of_scene;
    for (const Parameter* row : parameters()) {
        if (row->owner == Owner::Scene) of_scene.push_back(row->name);
        const auto sigma = s.free.prior_sigma.find(row->name);
        if (sigma == s.free.prior_sigma.end()) continue;
        core::check_range(
            sigma->second, {.low = 0}, key(fmt::format("free.{}.{}", row->name, row->prior)));
    }
    for (const std::string& name : s.free.parameters) require_known(name, key("free"), of_scene);
    for (const FreeObject& object : s.free.objects) {
        for (const std::string& name : object.parameters) {
            require_known(name, key("free." + object.name), free_names(Owner::Body));
        }
    }
    if (s.blur_schedule_m.empty() || s.blur_schedule_m.back() != 0.0) {
        throw core::Error(key("blur_schedule_m"),
                          "found no 0 at its end",
                          "must end in 0, since blurred counts are not Poisson");
    }
    for (const double blur : s.blur_schedule_m) {
        core::check_range(blur, {0, true}, key("blur_schedule_m"));
    }
    if (s.window_m && !((*s.window_m)[0] < (*s.window_m)[1])) {
        const auto [begin, end] = *s.window_m;
        throw core::Error(key("window_m"), fmt::format("found [{}, {}]", begin, end), "must grow");
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
