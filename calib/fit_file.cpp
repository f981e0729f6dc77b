// SPDX-License-Identifier: MIT
#include "calib/fit_file.h"

#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/settings_json.h"

#include <filesystem>

namespace calib {
namespace {

using core::Json;
using core::Vec3;

double value_of(const Json& json) {
    return json.is_number() ? json.get<double>() : kUnknown;
}

Vec3 vector_of(const Json& json) {
    return {value_of(json.at(0)), value_of(json.at(1)), value_of(json.at(2))};
}

// Values, or their standard deviations; "wall.bow_m" becomes bow_m of the object wall.
void write_estimates(const Estimates& estimates, bool sigmas, Json& json) {
    for (const auto& [key, estimate] : estimates) {
        const std::size_t dot = key.find('.');
        Json& target =
            dot == std::string::npos ? json[key] : json[key.substr(0, dot)][key.substr(dot + 1)];
        target = sigmas ? estimate.sigma : estimate.value;
    }
}

// What a result says of every quantity: its values, or their standard deviations.
Json estimates_json(const FitResult& result, bool sigmas) {
    Json json;
    json["objects"] = Json::object();
    json["scale"] = nullptr;  // where the contract has it
    json["point_scatterers"] = Json::array();
    write_estimates(result.estimates, sigmas, json);
    for (const FittedObject& o : result.objects) {
        const auto& q = o.rotation;
        Json& target = json["objects"][o.name];
        target["position_m"] = core::write_value(sigmas ? o.position_sigma_m : o.position_m);
        if (sigmas) {
            target["rotation_deg"] = core::write_value(o.rotation_sigma_deg);
        } else {
            target["rotation_wxyz"] = {q.w(), q.x(), q.y(), q.z()};
        }
        write_estimates(o.numbers, sigmas, target);
        if (!o.heights_m.empty()) target["heights_m"] = sigmas ? o.heights_sigma_m : o.heights_m;
    }
    for (const FittedPoint& p : result.points) {
        const Vec3& position = sigmas ? p.position_sigma_m : p.position_m;
        json["point_scatterers"].push_back(
            {position.x(), position.y(), position.z(), sigmas ? p.albedo.sigma : p.albedo.value});
    }
    return json;
}

}  // namespace

// An infinite standard deviation, of what the data do not determine, is written as null.
Json fit_json(const FitResult& result) {
    Json json = estimates_json(result, false);
    json["sigma"] = estimates_json(result, true);
    json["correlations"] = Json::array();
    for (const Correlation& c : result.correlations) {
        json["correlations"].push_back({{"a", c.a}, {"b", c.b}, {"value", c.value}});
    }
    json["condition_number"] = result.condition_number;
    json["unidentifiable"] = result.unidentifiable;
    json["warnings"] = result.warnings;
    json["residual"] = result.residual;
    json["deviance"] = result.deviance;
    json["expected_deviance"] = result.expected_deviance;
    json["expected_deviance_sigma"] = result.expected_deviance_sigma;
    json["iterations"] = result.iterations;
    json["seconds"] = result.seconds;
    json["converged"] = result.converged;
    json["message"] = result.message;
    json["pieces"] = result.num_elements;
    json["starts"] = Json::array();
    for (const FitStart& s : result.starts) {
        json["starts"].push_back({{"name", s.name}, {"cost", s.cost}});
    }
    return json;
}

FitResult read_fit(const std::string& path) {
    const Json json = core::read_json_file(path);
    FitResult result;
    try {
        for (const auto& [name, item] : json.at("objects").items()) {
            FittedObject& object = result.objects.emplace_back();
            object.name = name;
            object.position_m = vector_of(item.at("position_m"));
            const Json& q = item.at("rotation_wxyz");
            object.rotation = Eigen::Quaterniond(
                value_of(q.at(0)), value_of(q.at(1)), value_of(q.at(2)), value_of(q.at(3)));
            for (const auto& [key, value] : item.items()) {
                if (!value.is_array()) object.numbers.add(key, {value_of(value)});
            }
            const Json& sigma = json.at("sigma").at("objects").at(name);
            object.position_sigma_m = vector_of(sigma.at("position_m"));
            object.rotation_sigma_deg = vector_of(sigma.at("rotation_deg"));
        }
        for (const Json& item : json.at("point_scatterers")) {
            result.points.push_back({vector_of(item), Vec3::Zero(), {value_of(item.at(3))}});
        }
        result.seconds = value_of(json.at("seconds"));
        result.converged = json.at("converged").get<bool>();
        result.deviance = value_of(json.at("deviance"));
        result.expected_deviance = value_of(json.at("expected_deviance"));
    } catch (const nlohmann::json::exception&) {
        throw core::Error(path, "is no complete FIT.json", "must be what nlos fit wrote");
    }
    return result;
}

bool is_fit_file(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return false;
    const std::optional<Json> json = core::json_if_valid(core::MappedFile(path).bytes());
    return json && json->is_object() && json->contains("objects") && json->contains("sigma") &&
           json->contains("expected_deviance");
}

Json fitted_scene_json(const FitInput& input, const std::string& geometry_file) {
    renderer::SceneDescription scene = input.scene;
    renderer::refer_to_gltf(geometry_file, scene);
    renderer::describe_scan(input.capture.scan.wall(), scene.scan);
    scene.time_axis = {input.capture.time_axis};
    return core::write_value(scene);
}

}  // namespace calib
