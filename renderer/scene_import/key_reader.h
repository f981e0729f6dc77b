// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings_json.h"

#include <set>
#include <string>
#include <vector>

namespace renderer {

/// The text of a key; empty when `json` is no object, or has no text there.
std::string text_of(const core::Json& json, const std::string& key);

/// The `type` of a plugin; empty for all that is none.
inline std::string type_of(const core::Json& json) {
    return text_of(json, "type");
}

/// Takes the known keys out of an object of a foreign scene and remembers which were never taken.
class KeyReader {
 public:
    /// json    an object
    /// where   file and key of the object, for messages
    /// throws  core::Error when it is no object
    KeyReader(core::Json json, std::string where);

    const std::string& where() const { return where_; }
    std::string where(const std::string& key) const { return core::join_key(where_, key); }

    /// The value of a key, which lives as long as the reader; null when it is absent or null
    /// itself.
    const core::Json* find(const std::string& key);

    /// The value of a key, or `otherwise`. Throws core::Error when it has another type.
    template <class T>
    T get(const std::string& key, T otherwise) {
        if (const core::Json* value = find(key)) core::read_value(*value, where(key), otherwise);
        return otherwise;
    }

    /// Keys that mean nothing to the measurement.
    void ignore(std::initializer_list<const char*> keys) {
        taken_.insert(keys.begin(), keys.end());
    }

    /// The keys that nobody asked for, in the order of the file's keys; null ones are left out.
    std::vector<std::string> unread() const;

 private:
    core::Json json_;
    std::string where_;
    std::set<std::string> taken_;
};

}  // namespace renderer
