// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/error.h"
#include "renderer/core/types.h"

#include <array>
#include <concepts>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace core {

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

}  // namespace core
