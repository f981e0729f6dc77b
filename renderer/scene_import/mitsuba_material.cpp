// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/scene_import/foreign_file.h"
#include "renderer/scene_import/key_reader.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace renderer {
namespace {

using core::Json;

constexpr int kDeepestBsdf = 8;  // of BSDFs in BSDFs; references may form cycles

constexpr std::array<const char*, 18> kBsdfs{"diffuse",
                                             "twosided",
                                             "roughconductor",
                                             "conductor",
                                             "plastic",
                                             "roughplastic",
                                             "principled",
                                             "principledthin",
                                             "dielectric",
                                             "thindielectric",
                                             "mask",
                                             "bumpmap",
                                             "normalmap",
                                             "roughdielectric",
                                             "blendbsdf",
                                             "null",
                                             "pplastic",
                                             "measured"};

/// Linear reflectance at normal incidence, mean over red, green and blue, from the optical
/// constants that Mitsuba names so.
struct Metal {
    const char* name;
    double reflectance;
};
constexpr std::array<Metal, 6> kMetals{
    {{"Ag", 0.95}, {"Al", 0.91}, {"Au", 0.69}, {"Cr", 0.55}, {"Cu", 0.71}, {"none", 1.0}}};

/// Reads one material; the notes it leaves name the BSDF's key.
class MaterialImport {
 public:
    MaterialImport(const Json& scene, std::vector<std::string>& notes)
        : scene_(scene), notes_(notes) {}

    Material read(const Json& bsdf, const std::string& where, int depth = 0) {
        if (depth > kDeepestBsdf) {
            throw core::Error(where, "nests BSDFs without end", "must be a plain material");
        }
        if (type_of(bsdf) == "ref") {
            const std::string id = text_of(bsdf, "id");
            return read(referred(id, where), core::join_key(where, id), depth + 1);
        }
        KeyReader keys(bsdf, where);
        const std::string type = keys.get<std::string>("type", "");
        Material material;
        material.name = keys.get<std::string>("id", "");
        if (type == "diffuse") {
            material.albedo = reflectance(keys, "reflectance", 0.5);
        } else if (type == "twosided" || type == "mask" || type == "bumpmap" ||
                   type == "normalmap") {
            material = inner(keys, bsdf, depth);
            if (type != "twosided")
                note(where, type + " is not modelled; what it wraps counts alone");
        } else if (type == "roughconductor" || type == "conductor") {
            read_conductor(keys, type, material);
        } else {
            const bool is_principled = type.starts_with("principled");
            material.albedo =
                reflectance(keys, is_principled ? "base_color" : "diffuse_reflectance", 0.5);
            note(where, type + " is not modelled; its diffuse colour counts alone");
        }
        for (const std::string& key : keys.unread()) note(keys.where(key), "is not modelled");
        return material;
    }

 private:
    void note(const std::string& where, const std::string& text) {
        notes_.push_back(where + ": " + text);
    }

    const Json& referred(const std::string& id, const std::string& where) const {
        for (const auto& [key, value] : scene_.items()) {
            if (is_bsdf(value) && (key == id || text_of(value, "id") == id)) return value;
        }
        throw core::Error(where,
                          "refers to '" + id + "', which is no BSDF of the scene",
                          "must name the id of one");
    }

    Material inner(KeyReader& keys, const Json& bsdf, int depth) {
        for (const auto& [key, value] : bsdf.items()) {
            if (!leads_to_bsdf(value, scene_)) continue;
            keys.find(key);
            return read(value, keys.where(key), depth + 1);
        }
        throw core::Error(keys.where(), "holds no BSDF", "must wrap one");
    }

    void read_conductor(KeyReader& keys, const std::string& type, Material& material) {
        material.model = model_of({.metallic = true});
        material.albedo = metal(keys) * reflectance(keys, "specular_reflectance", 1.0);
        const double alpha = type == "conductor" ? 0.0 : keys.get("alpha", 0.1);
        core::check_range(alpha, {0.0, true, 1.0, true}, keys.where("alpha"));
        material.roughness = std::sqrt(alpha);
        if (type == "roughconductor" &&
            keys.get<std::string>("distribution", "beckmann") != "ggx") {
            note(keys.where("distribution"), "beckmann lobes are taken as GGX of the same width");
        }
    }

    /// Reflectance at normal incidence of a named metal, or of constants eta and k.
    double metal(KeyReader& keys) {
        const Json* eta = keys.find("eta");
        const Json* k = keys.find("k");
        if (eta != nullptr && k != nullptr) {
            const double n = colour(*eta, keys.where("eta"));
            const double a = colour(*k, keys.where("k"));
            return ((n - 1) * (n - 1) + a * a) / ((n + 1) * (n + 1) + a * a);
        }
        const std::string name = keys.get<std::string>("material", "none");
        for (const Metal& known : kMetals) {
            if (name == known.name) return known.reflectance;
        }
        note(keys.where("material"), name + " is not known; it reflects all at normal incidence");
        return 1.0;
    }

    double reflectance(KeyReader& keys, const char* key, double otherwise) {
        const Json* value = keys.find(key);
        if (value == nullptr) return otherwise;
        const std::string type = type_of(*value);
        if (value->is_object() && type != "rgb" && type != "spectrum" && type != "uniform") {
            note(keys.where(key),
                 fmt::format("textures are not translated; {:g} stands for it", otherwise));
            return otherwise;
        }
        const double result = colour(*value, keys.where(key));
        core::check_range(result, {0.0, true, 1.0, true}, keys.where(key));
        return result;
    }

    /// The mean of a number, of red, green and blue, or of a spectrum's samples.
    double colour(const Json& value, const std::string& where) {
        if (value.is_object()) return colour(value.value("value", Json()), where);
        if (value.is_string()) return colour_text(value.get<std::string>(), where);
        if (value.is_number()) {
            double number = 0.0;
            core::read_value(value, where, number);
            return number;
        }
        std::vector<double> values;
        core::read_value(value, where, values);
        if (values.size() == 3) return mean_albedo({values[0], values[1], values[2]});
        core::throw_wrong_type(where, value, "a number, or red, green and blue");
    }

    /// "#rrggbb", which is sRGB, or wavelengths with values: "400:0.5, 700:0.6".
    static double colour_text(const std::string& text, const std::string& where) {
        std::vector<double> values;
        try {
            if (text.starts_with('#') && text.size() == 7) {
                for (std::size_t at = 1; at < text.size(); at += 2) {
                    values.push_back(
                        linear_from_srgb(std::stoi(text.substr(at, 2), nullptr, 16) / 255.0));
                }
            } else {
                std::string sample;
                for (std::istringstream samples(text); std::getline(samples, sample, ',');) {
                    values.push_back(std::stod(sample.substr(sample.find(':') + 1)));
                }
            }
        } catch (const std::logic_error&) {
            values.clear();  // std::stod and std::stoi on what is no number
        }
        if (values.empty()) {
            core::throw_wrong_type(where, text, "#rrggbb, or wavelengths with values as 400:0.5");
        }
        return std::accumulate(values.begin(), values.end(), 0.0) /
               static_cast<double>(values.size());
    }

    const Json& scene_;
    std::vector<std::string>& notes_;
};

}  // namespace

bool is_bsdf(const core::Json& plugin) {
    return plugin.is_object() &&
           std::find(kBsdfs.begin(), kBsdfs.end(), type_of(plugin)) != kBsdfs.end();
}

bool leads_to_bsdf(const core::Json& plugin, const core::Json& scene) {
    if (type_of(plugin) != "ref") return is_bsdf(plugin);
    const std::string id = text_of(plugin, "id");
    for (const auto& [key, value] : scene.items()) {
        if (key == id || text_of(value, "id") == id) return is_bsdf(value);
    }
    return true;  // to be named as missing
}

Material mitsuba_material(const core::Json& bsdf,
                          const core::Json& scene,
                          const std::string& where,
                          std::vector<std::string>& not_translated) {
    return MaterialImport(scene, not_translated).read(bsdf, where);
}

}  // namespace renderer
