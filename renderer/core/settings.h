// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/error.h"
#include "renderer/core/types.h"

#include <nlohmann/json.hpp>

#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace core {

/// Keeps keys in the order in which they were listed.
using Json = nlohmann::ordered_json;

/// Settings are structs with defaults whose fields are listed once:
///
///     template <class Visitor> void for_each_field(TimeAxis& axis, Visitor&& visit) {
///         visit("num_bins", axis.num_bins, "number of bins");  ...
///     }
///
/// From that list come JSON reading, `--set key.path=value`, the help text, errors about unknown
/// keys, the check of ranges and the echo stored with every result. The meaning of a number may
/// come with its range, as in `core::at_least(1, "number of bins")`. A field is a value, an enum
/// that specialises EnumNames, a struct with fields of its own, or an optional of any of these
/// (null when empty).
struct AnyVisitor {
    template <class T>
    void operator()(const char*, T&, const char*) const {}
};
template <class T>
concept SettingsStruct = requires(T& value, AnyVisitor visitor) {
    for_each_field(value, visitor);
};

/// An interval of numbers, each end with or without its bound.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    bool with_low = false;
    double high = std::numeric_limits<double>::infinity();
    bool with_high = false;
};

/// What a field means and which numbers it may hold; converts to the meaning for visitors that
/// want nothing else.
struct Ranged {
    const char* meaning;
    Range range;

    constexpr operator const char*() const { return meaning; }
};
constexpr Ranged at_least(double low, const char* meaning) {
    return {meaning, {.low = low, .with_low = true}};
}
constexpr Ranged above(double low, const char* meaning) {
    return {meaning, {.low = low}};
}
constexpr Ranged between(double low, double high, const char* meaning) {
    return {meaning, {low, true, high, true}};
}
constexpr Ranged strictly_between(double low, double high, const char* meaning) {
    return {meaning, {.low = low, .high = high}};
}

/// Specialise with `static constexpr auto value = names_from_zero<E>("first", "second")`.
template <class E>
struct EnumNames;

/// The enumerators of E, which count up from 0, with a name for each.
template <class E, class... Names>
constexpr auto names_from_zero(const Names&... names) {
    int next = 0;
    return std::array{std::pair<E, std::string_view>{static_cast<E>(next++), names}...};
}

template <class E>
std::vector<std::string> enum_names() {
    std::vector<std::string> names;
    for (const auto& [value, name] : EnumNames<E>::value) names.emplace_back(name);
    return names;
}

/// Names with `|` between them.
std::string choices_text(const std::vector<std::string>& names);

template <class E>
std::string enum_choices() {
    return choices_text(enum_names<E>());
}

template <class E>
std::string_view enum_name(E wanted) {
    for (const auto& [value, name] : EnumNames<E>::value) {
        if (value == wanted) return name;
    }
    return "?";
}

/// Throws Error `where: found <found>; must be <allowed>` unless `holds`; `where` is the full key.
void require(bool holds, const std::string& where, double found, const std::string& allowed);
void require(bool holds,
             const std::string& where,
             const std::string& found,
             const std::string& allowed);

/// The name of a key below `where`, as errors print it.
std::string join_key(const std::string& where, const std::string& key);

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

/// A point or a direction in words: "(0.5, 0, 1.25)".
std::string vector_text(const Vec3& vector);

/// The range in words, as in "at least 0 and below 1"; empty for all numbers.
std::string range_text(const Range& range);

/// Throws Error unless a number is finite and in a range, each number of a list, and that of an
/// optional if it has one; `where` is the full key.
void check_range(double value, const Range& range, const std::string& where);
template <std::integral T>
void check_range(T value, const Range& range, const std::string& where) {
    check_range(static_cast<double>(value), range, where);
}
template <class T, std::size_t N>
void check_range(const std::array<T, N>& values, const Range& range, const std::string& where) {
    for (const T& value : values) check_range(value, range, where);
}
template <class T>
void check_range(const std::optional<T>& value, const Range& range, const std::string& where) {
    if (value) check_range(*value, range, where);
}

/// Throws Error for a field outside the range in the list of fields. Fields with fields of their
/// own are left to their validate().
template <SettingsStruct S>
void check_ranges(S settings, const std::string& where) {
    for_each_field(settings, [&](const char* name, auto& field, const auto& meaning) {
        if constexpr (std::same_as<decltype(meaning), const Ranged&>) {
            check_range(field, meaning.range, join_key(where, name));
        }
    });
}

/// Parses `key.path=value` into nested JSON; the value is JSON or, failing that, a string.
/// Throws Error when there is no '=' or an empty key.
Json parse_override(const std::string& text);

/// Applies one `--set key.path=value`.
template <SettingsStruct S>
void apply_override(S& settings, const std::string& text) {
    read_value(parse_override(text), "--set", settings);
}

/// Parses JSON text, which may come from anywhere.
///
/// where    names the text in messages
/// throws   Error when it is not JSON, is nested deeper than 100, or has a key twice in an object
Json parse_json(std::string_view text, const std::string& where);

/// The same; nothing when the text is no such JSON.
std::optional<Json> json_if_valid(std::string_view text);

/// JSON as files of ours hold it, indented, with U+FFFD for what is no UTF-8, as names of files may
/// be.
std::string json_text(const Json& json);

/// Reads a whole JSON file. Throws Error when it is missing or parse_json() refuses it.
Json read_json_file(const std::string& path);

}  // namespace core
