// SPDX-License-Identifier: MIT
#include "apps/sweep/sweep_settings.h"

#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string_view>

namespace apps {
namespace {

constexpr std::array<std::string_view, 3> kParts{"scene", "noise", "reconstruct"};
constexpr double kMostRuns = 1e6;  // their numbers have six digits

/// The keys of "key, key".
std::vector<std::string> split_keys(const std::string& text, const std::string& where) {
    std::vector<std::string> keys;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::size_t first = std::min(text.find_first_not_of(' ', begin), end);
        std::size_t last = end;
        while (last > first && text[last - 1] == ' ') --last;
        keys.push_back(text.substr(first, last - first));
        begin = end + 1;
    }
    for (const std::string& key : keys) {
        const std::size_t dot = key.find('.');
        const bool has_part = std::ranges::count(kParts, key.substr(0, dot)) == 1;
        if (has_part && dot != std::string::npos && !key.ends_with('.') &&
            key.find("..") == std::string::npos) {
            continue;
        }
        throw core::Error(where,
                          "found the key '" + key + "'",
                          "must be a setting's, such as scene.scan.sensing_points, "
                          "noise.photons_per_point or reconstruct.method");
    }
    return keys;
}

SweepAxis read_axis(const std::string& key, const core::Json& json, const std::string& where) {
    SweepAxis axis{split_keys(key, where), {}};
    const std::string key_path = core::join_key(where, key);
    if (!json.is_array() || json.empty()) {
        core::throw_wrong_type(key_path, json, "a list of at least one value");
    }
    for (const core::Json& value : json) {
        if (axis.keys.size() == 1) {
            axis.values.push_back({value});
            continue;
        }
        if (!value.is_array() || value.size() != axis.keys.size()) {
            core::throw_wrong_type(
                key_path, value, fmt::format("a list of {} values, one per key", axis.keys.size()));
        }
        axis.values.emplace_back(value.begin(), value.end());
    }
    return axis;
}

// Keys may also be nested, as --set makes them: only lists are values.
void read_axes(const core::Json& json,
               const std::string& where,
               const std::string& prefix,
               std::vector<SweepAxis>& axes) {
    for (const auto& [name, value] : json.items()) {
        const std::string key = prefix.empty() ? name : prefix + "." + name;
        if (value.is_object() && !value.empty()) {
            read_axes(value, where, key, axes);
        } else {
            axes.push_back(read_axis(key, value, where));
        }
    }
}

/// Whether `key` stands in nested values, or a part or a whole of it does.
bool is_set(const core::Json& values, const std::string& key) {
    const core::Json* level = &values;
    for (std::size_t begin = 0; begin <= key.size();) {
        if (!level->is_object()) return true;
        const std::size_t end = std::min(key.find('.', begin), key.size());
        const auto it = level->find(key.substr(begin, end - begin));
        if (it == level->end()) return false;
        level = &*it;
        begin = end + 1;
    }
    return true;
}

void check_grid(const SweepSettings& sweep, const std::string& where) {
    core::Json seen = core::Json::object();
    double num_runs = sweep.repeats;
    for (const SweepAxis& axis : sweep.grid.axes) {
        num_runs *= static_cast<double>(axis.values.size());
        for (const std::string& key : axis.keys) {
            const bool is_fixed = is_set(sweep.fixed.values, key);
            if (is_fixed || is_set(seen, key)) {
                throw core::Error(where + "grid." + key,
                                  is_fixed ? "found among fixed as well" : "found twice",
                                  "must be set in one place");
            }
            merge_values(nested_value(key, 0), seen);
        }
    }
    core::require(num_runs <= kMostRuns,
                  where + "grid",
                  fmt::format("{:g} runs", num_runs),
                  fmt::format("at most {:g}", kMostRuns));
}

}  // namespace

std::string SweepAxis::name() const {
    return fmt::format("{}", fmt::join(keys, ", "));
}

core::Json nested_value(const std::string& key, core::Json value) {
    const std::size_t dot = key.rfind('.');
    core::Json outer = core::Json::object();
    outer[dot == std::string::npos ? key : key.substr(dot + 1)] = std::move(value);
    return dot == std::string::npos ? outer : nested_value(key.substr(0, dot), std::move(outer));
}

void merge_values(const core::Json& changes, core::Json& values) {
    if (!changes.is_object() || !values.is_object()) {
        values = changes;
        return;
    }
    for (const auto& [key, change] : changes.items()) merge_values(change, values[key]);
}

void read_value(const core::Json& json, const std::string& where, SweepPlot& plot) {
    core::read_value<SweepPlot>(json, where, plot);
}

void read_value(const core::Json& json, const std::string& where, SweepGrid& grid) {
    if (!json.is_object()) core::throw_wrong_type(where, json, "an object from keys to lists");
    std::vector<SweepAxis> axes;
    read_axes(json, where, "", axes);
    std::set<std::string> names;
    for (SweepAxis& axis : axes) {
        if (!names.insert(axis.name()).second) {
            throw core::Error(
                core::join_key(where, axis.name()), "found twice", "must be set in one place");
        }
        const auto same = std::ranges::find(grid.axes, axis.keys, &SweepAxis::keys);
        if (same == grid.axes.end()) {
            grid.axes.push_back(std::move(axis));
        } else {
            *same = std::move(axis);
        }
    }
}

core::Json write_value(const SweepGrid& grid) {
    core::Json json = core::Json::object();
    for (const SweepAxis& axis : grid.axes) {
        core::Json& list = json[axis.name()] = core::Json::array();
        for (const auto& values : axis.values) {
            list.push_back(axis.keys.size() == 1 ? values.front() : core::Json(values));
        }
    }
    return json;
}

void read_value(const core::Json& json, const std::string& where, SweepFixed& fixed) {
    if (!json.is_object()) core::throw_wrong_type(where, json, "an object from keys to values");
    core::Json given = core::Json::object();
    for (const auto& [key, value] : json.items()) {
        const bool is_part = std::ranges::count(kParts, key) == 1;
        if (is_part && !value.is_object()) {
            core::throw_wrong_type(core::join_key(where, key), value, "an object of settings");
        }
        if (!is_part && split_keys(key, where).size() > 1) {
            throw core::Error(
                core::join_key(where, key), "found a list of keys", "must be one key");
        }
        const core::Json nested = nested_value(key, value);
        if (!is_part && is_set(given, key)) {
            throw core::Error(
                core::join_key(where, key), "found twice", "must be set in one place");
        }
        merge_values(nested, given);
    }
    merge_values(given, fixed.values);
}

core::Json write_value(const SweepFixed& fixed) {
    return fixed.values;
}

SweepSettings read_sweep(const std::string& path, const std::vector<std::string>& overrides) {
    const std::string where = path + ": ";
    SweepSettings sweep;
    core::read_value(core::read_json_file(path), where, sweep);
    for (const std::string& text : overrides) core::apply_override(sweep, text);
    core::check_ranges(sweep, where);
    core::require(!sweep.scene.empty(), where + "scene", "nothing", "the path of a scene.json");
    check_grid(sweep, where);
    sweep.scene = (std::filesystem::path(path).parent_path() / sweep.scene).string();
    return sweep;
}

}  // namespace apps
