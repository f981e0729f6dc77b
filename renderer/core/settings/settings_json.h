// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_file.h"
#include "renderer/core/settings/settings.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace core {

/// Throws the error for a JSON value of the wrong type: `where: found <json>; must be <allowed>`.
[[noreturn]] void throw_wrong_type(const std::string& where,
                                   const Json& found,
                                   const std::string& allowed);

/// Throws the error for a JSON value that is none of these names, with the nearest of them.
[[noreturn]] void throw_unknown_name(const std::string& where,
                                     const Json& found,
                                     const std::vector<std::string>& names);

// Values of settings. Each throws Error naming `where` when the JSON has another type or shape.
void read_value(const Json& json, const std::string& where, bool& value);
void read_value(const Json& json, const std::string& where, int& value);
void read_value(const Json& json, const std::string& where, std::uint64_t& value);
void read_value(const Json& json, const std::string& where, double& value);
void read_value(const Json& json, const std::string& where, std::string& value);
void read_value(const Json& json, const std::string& where, Vec3& value);

template <class E>
requires std::is_enum_v<E>
void read_value(const Json& json, const std::string& where, E& value) {
    if (json.is_string()) {
        for (const auto& [candidate, name] : EnumNames<E>::value) {
            if (json.get_ref<const std::string&>() == name) {
                value = candidate;
                return;
            }
        }
    }
    throw_unknown_name(where, json, enum_names<E>());
}

template <class T, std::size_t N>
void read_value(const Json& json, const std::string& where, std::array<T, N>& value) {
    if (!json.is_array() || json.size() != N) {
        throw_wrong_type(where, json, "a list of " + std::to_string(N) + " numbers");
    }
    for (std::size_t i = 0; i < N; ++i) {
        read_value(json[i], where + "[" + std::to_string(i) + "]", value[i]);
    }
}

template <class T>
void read_value(const Json& json, const std::string& where, std::vector<T>& value) {
    if (!json.is_array()) throw_wrong_type(where, json, "a list");
    value.clear();
    for (std::size_t i = 0; i < json.size(); ++i) {
        read_value(json[i], where + "[" + std::to_string(i) + "]", value.emplace_back());
    }
}

/// A table: an object with one value per key. Others of the table stay as they are.
template <class T>
void read_value(const Json& json, const std::string& where, std::map<std::string, T>& table) {
    if (!json.is_object()) throw_wrong_type(where, json, "an object with one value per key");
    for (const auto& [key, value] : json.items()) {
        read_value(value, join_key(where, key), table[key]);
    }
}

template <class S>
requires SettingsStruct<S>
void read_value(const Json& json, const std::string& where, S& settings);

template <class T>
void read_value(const Json& json, const std::string& where, std::optional<T>& value) {
    if (json.is_null()) {
        value.reset();
        return;
    }
    if (!value) value.emplace();
    read_value(json, where, *value);
}

/// Throws Error for keys of `json` that are not among `known`, naming the nearest and all of them.
void check_keys(const Json& json, const std::string& where, const std::vector<std::string>& known);

/// Reads the keys present in `json` into `settings` and leaves the others as they are.
template <class S>
requires SettingsStruct<S>
void read_value(const Json& json, const std::string& where, S& settings) {
    if (!json.is_object()) throw_wrong_type(where, json, "an object with named fields");
    std::vector<std::string> known;
    for_each_field(settings, [&](const char* name, auto& field, const char*) {
        known.emplace_back(name);
        if (const auto it = json.find(name); it != json.end()) {
            read_value(*it, join_key(where, name), field);
        }
    });
    check_keys(json, where, known);
}

template <class T>
requires std::is_arithmetic_v<T> || std::same_as<T, std::string> Json write_value(const T& value) {
    return value;
}
inline Json write_value(const Vec3& value) {
    return {value.x(), value.y(), value.z()};
}

template <class E>
requires std::is_enum_v<E> Json write_value(E value) {
    return std::string(enum_name(value));
}

template <class S>
requires SettingsStruct<S> Json write_value(S settings);

template <class T>
Json write_value(const std::optional<T>& value);

template <class List>
requires requires(const List& list) {
    list.begin();
    typename List::value_type;
    requires !std::same_as<List, std::string>;
} &&(!SettingsStruct<List>)Json write_value(const List& list) {
    Json json = Json::array();
    for (const auto& item : list) json.push_back(write_value(item));
    return json;
}

template <class T>
Json write_value(const std::map<std::string, T>& table) {
    Json json = Json::object();
    for (const auto& [key, value] : table) json[key] = write_value(value);
    return json;
}
template <class T>
Json write_value(const std::optional<T>& value) {
    return value ? write_value(*value) : Json(nullptr);
}

/// All fields with their present values: the settings echo.
template <class S>
requires SettingsStruct<S> Json write_value(S settings) {
    Json json = Json::object();
    for_each_field(settings, [&](const char* name, auto& field, const char*) {
        json[name] = write_value(field);
    });
    return json;
}

/// Parses `key.path=value` into nested JSON; the value is JSON or, failing that, a string.
/// Throws Error when there is no '=' or an empty key.
Json parse_override(const std::string& text);

/// Applies one `--set key.path=value`.
template <SettingsStruct S>
void apply_override(S& settings, const std::string& text) {
    read_value(parse_override(text), "--set", settings);
}

}  // namespace core
