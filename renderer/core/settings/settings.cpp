// SPDX-License-Identifier: MIT
#include "renderer/core/nearest_name.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace core {
namespace {

std::string shortened(const Json& json) {
    constexpr std::size_t kLongest = 60;
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
    return text;
}

}  // namespace

void require(bool holds, const std::string& where, double found, const std::string& allowed) {
    if (!holds) require(false, where, fmt::format("{}", found), allowed);
}

void require(bool holds,
             const std::string& where,
             const std::string& found,
             const std::string& allowed) {
    if (!holds) throw Error(where, "found " + found, "must be " + allowed);
}

void throw_wrong_type(const std::string& where, const Json& found, const std::string& allowed) {
    // The root of a file has no key to name.
    throw Error(where.ends_with(": ") ? where.substr(0, where.size() - 2) : where,
                "found " + shortened(found),
                "must be " + allowed);
}

void throw_unknown_name(const std::string& where,
                        const Json& found,
                        const std::vector<std::string>& names) {
    const std::string nearest =
        found.is_string() ? did_you_mean(found.get_ref<const std::string&>(), names) : "";
    throw Error(
        where, "found " + shortened(found), nearest + "must be one of " + choices_text(names));
}

std::string choices_text(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, "|"));
}

std::string join_key(const std::string& where, const std::string& key) {
    if (where.empty() || where.ends_with(": ")) return where + key;
    return where + (where == "--set" ? " " : ".") + key;
}

void read_value(const Json& json, const std::string& where, bool& value) {
    if (!json.is_boolean()) throw_wrong_type(where, json, "true or false");
    value = json.get<bool>();
}

void read_value(const Json& json, const std::string& where, int& value) {
    const bool whole =
        json.is_number_integer() ||
        (json.is_number_float() && std::trunc(json.get<double>()) == json.get<double>());
    if (!whole) throw_wrong_type(where, json, "a whole number");
    constexpr int kLargest = std::numeric_limits<int>::max();
    if (std::abs(json.get<double>()) > kLargest) {
        throw_wrong_type(where, json, fmt::format("between -{} and {}", kLargest, kLargest));
    }
    value = static_cast<int>(json.get<double>());
}

void read_value(const Json& json, const std::string& where, std::uint64_t& value) {
    if (!json.is_number_integer() || (!json.is_number_unsigned() && json.get<std::int64_t>() < 0)) {
        throw_wrong_type(where, json, "a whole number that is not negative");
    }
    value = json.get<std::uint64_t>();
}

void read_value(const Json& json, const std::string& where, double& value) {
    if (!json.is_number() || !std::isfinite(json.get<double>())) {
        throw_wrong_type(where, json, "a finite number");
    }
    value = json.get<double>();
}

void read_value(const Json& json, const std::string& where, std::string& value) {
    if (!json.is_string()) throw_wrong_type(where, json, "a text");
    value = json.get<std::string>();
}

void read_value(const Json& json, const std::string& where, Vec3& value) {
    std::array<double, 3> numbers{};
    read_value(json, where, numbers);
    value = Vec3(numbers[0], numbers[1], numbers[2]);
}

void check_keys(const Json& json, const std::string& where, const std::vector<std::string>& known) {
    for (const auto& [key, value] : json.items()) {
        if (std::find(known.begin(), known.end(), key) == known.end()) {
            throw Error(join_key(where, key),
                        "found an unknown key",
                        did_you_mean(key, known) +
                            fmt::format("known keys are {}", fmt::join(known, ", ")));
        }
    }
}

std::string vector_text(const Vec3& vector) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", vector.x(), vector.y(), vector.z());
}

std::string range_text(const Range& range) {
    std::string text;
    if (std::isfinite(range.low)) {
        text = fmt::format("{} {}", range.with_low ? "at least" : "above", range.low);
    }
    if (std::isfinite(range.high)) {
        text += fmt::format("{}{} {}",
                            text.empty() ? "" : " and ",
                            range.with_high ? "at most" : "below",
                            range.high);
    }
    return text;
}

void check_range(double value, const Range& range, const std::string& where) {
    const bool above = range.with_low ? value >= range.low : value > range.low;
    const bool below = range.with_high ? value <= range.high : value < range.high;
    if (above && below && std::isfinite(value)) return;
    require(false, where, value, std::isfinite(value) ? range_text(range) : "finite");
}

Json parse_override(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
        throw Error("--set", "found '" + text + "'", "must be key.path=value");
    }
    const std::string value_text = text.substr(equals + 1);
    Json value = json_if_valid(value_text).value_or(value_text);

    std::string path = text.substr(0, equals);
    while (true) {
        const std::size_t dot = path.rfind('.');
        const std::string key = dot == std::string::npos ? path : path.substr(dot + 1);
        if (key.empty()) throw Error("--set", "found '" + text + "'", "must be key.path=value");
        Json outer = Json::object();
        outer[key] = std::move(value);
        value = std::move(outer);
        if (dot == std::string::npos) return value;
        path.resize(dot);
    }
}

}  // namespace core
