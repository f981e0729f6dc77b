// SPDX-License-Identifier: MIT
#include "nlos/formats/ytal_layout.h"

#include "renderer/core/settings/json_file.h"

namespace nlos {
namespace {

constexpr const char* kYamlKey = "yaml";

/// YAML 1.1 takes 1e-05 for a text and 1.0e-05 for a number; JSON takes both for numbers.
std::string with_decimal_points(const std::string& json) {
    std::string text;
    bool in_string = false;
    bool in_number = false;
    bool has_point = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (in_string) {
            text += c;
            if (c == '\\') {
                text += json[++i];
            } else if (c == '"') {
                in_string = false;
            }
            continue;
        }
        const bool digit = c >= '0' && c <= '9';
        if (in_number && c == 'e' && !has_point) text += ".0";
        has_point = (in_number && has_point) || c == '.';
        in_number = digit || (in_number && (c == '.' || c == 'e' || c == '-' || c == '+'));
        if (!in_number) has_point = false;
        in_string = c == '"';
        text += c;
    }
    return text;
}

}  // namespace

std::string scene_info_text(const core::Json& scene_info) {
    if (scene_info.is_object() && scene_info.size() == 1 && scene_info.contains(kYamlKey) &&
        scene_info[kYamlKey].is_string()) {
        return scene_info[kYamlKey].get<std::string>();
    }
    constexpr int kIndent = 2;
    return with_decimal_points(
        scene_info.dump(kIndent, ' ', false, core::Json::error_handler_t::replace));
}

core::Json parse_scene_info(const std::string& text) {
    const std::optional<core::Json> json = core::json_if_valid(text);
    if (json && json->is_object()) return *json;
    return core::Json{{kYamlKey, text}};
}

}  // namespace nlos
