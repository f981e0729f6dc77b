// SPDX-License-Identifier: MIT
#include "renderer/scene_import/key_reader.h"

#include "renderer/core/settings/settings_json.h"

namespace renderer {

std::string text_of(const core::Json& json, const std::string& key) {
    if (!json.is_object()) return "";
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

KeyReader::KeyReader(core::Json json, std::string where)
    : json_(std::move(json)), where_(std::move(where)) {
    if (!json_.is_object()) core::throw_wrong_type(where_, json_, "an object with named keys");
}

const core::Json* KeyReader::find(const std::string& key) {
    taken_.insert(key);
    const auto found = json_.find(key);
    return found == json_.end() || found->is_null() ? nullptr : &*found;
}

std::vector<std::string> KeyReader::unread() const {
    std::vector<std::string> keys;
    for (const auto& [key, value] : json_.items()) {
        if (!taken_.contains(key) && !value.is_null()) keys.push_back(key);
    }
    return keys;
}

}  // namespace renderer
