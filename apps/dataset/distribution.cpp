// SPDX-License-Identifier: MIT
#include "apps/dataset/distribution.h"

#include "renderer/core/settings/settings_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace apps {
namespace {

using Kind = Distribution::Kind;

constexpr double kNormalCut = 3.0;
constexpr const char* kForms =
    R"(a value, or {"uniform": [a, b]}, {"log_uniform": [a, b]}, {"normal": [mean, deviation]}, )"
    R"({"integers": [first, last]} or {"choices": [x, y, ...]})";

void read_two_numbers(const core::Json& json,
                      const std::string& where,
                      Distribution& distribution) {
    std::array<double, 2> numbers{};
    core::read_value(json, where, numbers);
    const auto& [first, second] = numbers;
    const Kind kind = distribution.kind;
    if (kind == Kind::Normal) {
        core::require(second >= 0.0, where + "[1]", second, "a standard deviation of at least 0");
    } else {
        core::require(first <= second, where, json.dump(), "two numbers in rising order");
    }
    if (kind == Kind::LogUniform) core::require(first > 0.0, where + "[0]", first, "above 0");
    if (kind == Kind::Integers) {
        const bool whole = first == std::floor(first) && second == std::floor(second);
        core::require(whole, where, json.dump(), "whole numbers");
    }
    distribution.first = first;
    distribution.second = second;
}

/// Box and Muller's [Box1958].
double draw_normal(core::Rng& rng) {
    for (;;) {
        const double radius = std::sqrt(-2.0 * std::log(1.0 - rng.uniform()));
        const double value = radius * std::cos(2.0 * std::numbers::pi * rng.uniform());
        if (std::abs(value) <= kNormalCut) return value;
    }
}

double draw_between(const Distribution& d, core::Rng& rng) {
    switch (d.kind) {
        case Kind::LogUniform:
            return std::min(d.second, d.first * std::pow(d.second / d.first, rng.uniform()));
        case Kind::Normal:
            return d.first + d.second * draw_normal(rng);
        case Kind::Integers:
            return std::min(d.second,
                            d.first + std::floor(rng.uniform() * (d.second - d.first + 1.0)));
        default:
            return d.first + (d.second - d.first) * rng.uniform();
    }
}

core::Json number(const Distribution& distribution, double value) {
    if (distribution.kind == Kind::Integers) return static_cast<std::int64_t>(value);
    return value;
}

bool has_values(const Distribution& distribution) {
    return distribution.kind == Kind::Constant || distribution.kind == Kind::Choices;
}

}  // namespace

void read_value(const core::Json& json, const std::string& where, Distribution& distribution) {
    if (!json.is_object()) {
        distribution = Distribution::constant(json);
        return;
    }
    if (json.size() != 1) core::throw_wrong_type(where, json, kForms);
    const std::string& name = json.begin().key();
    const core::Json& content = json.begin().value();
    const std::string key = core::join_key(where, name);
    distribution = {};
    for (const auto& [kind, known] : core::EnumNames<Kind>::value) {
        if (name == known) distribution.kind = kind;
    }
    if (distribution.kind == Kind::Constant) core::throw_wrong_type(where, json, kForms);
    if (distribution.kind != Kind::Choices) return read_two_numbers(content, key, distribution);
    if (!content.is_array() || content.empty()) {
        core::throw_wrong_type(key, content, "a list of at least one value");
    }
    distribution.values.assign(content.begin(), content.end());
}

core::Json write_value(const Distribution& distribution) {
    if (distribution.kind == Kind::Constant) return distribution.values.at(0);
    const std::string name(core::enum_name(distribution.kind));
    if (distribution.kind == Kind::Choices) return {{name, distribution.values}};
    return {
        {name,
         {number(distribution, distribution.first), number(distribution, distribution.second)}}};
}

core::Json draw(const Distribution& distribution, core::Rng& rng) {
    if (!has_values(distribution)) return number(distribution, draw_between(distribution, rng));
    const std::size_t count = distribution.values.size();
    if (count == 1) return distribution.values[0];
    const auto index = static_cast<std::size_t>(rng.uniform() * static_cast<double>(count));
    return distribution.values[std::min(index, count - 1)];
}

double draw_number(const Distribution& distribution, core::Rng& rng) {
    return draw(distribution, rng).get<double>();
}

std::vector<core::Json> extremes(const Distribution& distribution) {
    if (has_values(distribution)) return distribution.values;
    const bool is_normal = distribution.kind == Kind::Normal;
    const double reach = kNormalCut * distribution.second;
    return {number(distribution, is_normal ? distribution.first - reach : distribution.first),
            number(distribution, is_normal ? distribution.first + reach : distribution.second)};
}

void check_range(const Distribution& distribution,
                 const core::Range& range,
                 const std::string& where) {
    for (const core::Json& value : extremes(distribution)) {
        if (!value.is_number()) core::throw_wrong_type(where, value, "a number");
        core::check_range(value.get<double>(), range, where);
    }
}

void read_value(const core::Json& json, const std::string& where, DrawTable& table) {
    if (!json.is_object()) {
        core::throw_wrong_type(where, json, "an object from dotted keys to distributions");
    }
    for (const auto& [key, content] : json.items()) {
        read_value(content, core::join_key(where, key), table[key]);
    }
}

core::Json write_value(const DrawTable& table) {
    core::Json json = core::Json::object();
    for (const auto& [key, distribution] : table) json[key] = write_value(distribution);
    return json;
}

}  // namespace apps
