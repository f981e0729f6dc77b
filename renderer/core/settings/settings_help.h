// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings_json.h"

namespace core {

/// What help says of a setting.
struct SettingHelp {
    std::string key;  ///< full, dotted
    std::string default_value;
    std::string meaning;
    std::vector<std::string> choices;  ///< the values that it may have; empty: no closed set
    std::string range;                 ///< of its numbers, in words; empty: any

    /// The meaning, with the choices or the range behind it.
    std::string text() const {
        const std::string limits = choices.empty() ? range : choices_text(choices);
        return limits.empty() ? meaning : meaning + " (" + limits + ")";
    }
};

template <class T>
std::vector<std::string> choices_of(const T&) {
    if constexpr (std::is_enum_v<T>) return enum_names<T>();
    return {};
}
template <class T>
std::vector<std::string> choices_of(const std::optional<T>&) {
    return choices_of(T{});
}

/// The settings in a field, which is one of them or has fields of its own.
template <class T>
struct NestedSettings {
    static constexpr bool exist = SettingsStruct<T>;
    using Type = T;
};
template <class T>
struct NestedSettings<std::optional<T>> : NestedSettings<T> {};

/// Lists every field with default and meaning, nested ones by their dotted key; fields of what is
/// null by default come behind the line that says so.
template <SettingsStruct S>
std::vector<SettingHelp> settings_help(S defaults, const std::string& prefix = "") {
    std::vector<SettingHelp> lines;
    for_each_field(defaults, [&](const char* name, auto& field, const auto& meaning) {
        using Field = std::remove_cvref_t<decltype(field)>;
        using Nested = NestedSettings<Field>;
        if constexpr (!SettingsStruct<Field>) {
            SettingHelp line{prefix + name, write_value(field).dump(), "", choices_of(field), ""};
            line.meaning = static_cast<const char*>(meaning);
            if constexpr (std::same_as<decltype(meaning), const Ranged&>) {
                line.range = range_text(meaning.range);
            }
            lines.push_back(std::move(line));
        }
        if constexpr (Nested::exist) {
            typename Nested::Type inner{};
            if constexpr (SettingsStruct<Field>) inner = field;
            const auto nested = settings_help(inner, prefix + name + ".");
            lines.insert(lines.end(), nested.begin(), nested.end());
        }
    });
    return lines;
}

}  // namespace core
