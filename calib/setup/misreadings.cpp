// SPDX-License-Identifier: MIT
#include "calib/setup/misreadings.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace calib {
namespace {

/// Adds the observations as `correct` changes them.
void add(const SetupObservations& o,
         std::string looks,
         std::string help,
         const std::function<void(SetupObservations&)>& correct,
         std::vector<Misreading>& list) {
    correct(list.emplace_back(Misreading{std::move(looks), std::move(help), o}).corrected);
}

void add_reversed_time(const SetupObservations& o, std::vector<Misreading>& list) {
    const auto reverse = [](SetupObservations& c) {
        for (DirectReturn& one : c.returns) {
            one.opl_m = c.axis.opl_start_m + c.axis.opl_end_m() - one.opl_m;
        }
    };
    add(o, "time looks reversed", "capture.flip_t=true turns it", reverse, list);
}

void add_command_units(const SetupObservations& o, std::vector<Misreading>& list) {
    constexpr std::array<const char*, 3> kUnits{"radians", "degrees", "milliradians"};
    if (!angle_of(o.command_unit) || o.galvo_gain) return;
    for (const auto& [unit, name] : core::EnumNames<CommandUnit>::value) {
        if (!angle_of(unit) || unit == o.command_unit) continue;
        add(
            o,
            fmt::format("the commands look like {}", kUnits[static_cast<std::size_t>(unit)]),
            fmt::format("command_unit={}", name),
            [unit = unit](SetupObservations& c) { c.command_unit = unit; },
            list);
    }
}

struct LengthUnit {
    const char* name;
    double metres;
};
constexpr std::array<LengthUnit, 3> kLengthUnits{
    LengthUnit{"millimetres", 1e-3},
    LengthUnit{"nanoseconds", 1e-9 * core::kSpeedOfLight},
    LengthUnit{"picoseconds", 1e-12 * core::kSpeedOfLight}};

void add_axis_units(const SetupObservations& o, std::vector<Misreading>& list) {
    for (const LengthUnit& unit : kLengthUnits) {
        const double start_m = unit.metres * o.axis.opl_start_m;
        add(
            o,
            fmt::format("the time axis looks like {} where metres of path length are meant",
                        unit.name),
            fmt::format("capture.bin_width_m={:.6g} capture.opl_shift_m={:.6g}",
                        unit.metres * o.axis.bin_width_m,
                        start_m - o.axis.opl_start_m),
            [&](SetupObservations& c) {
                c.axis.opl_start_m = start_m;
                c.axis.bin_width_m *= unit.metres;
                for (DirectReturn& one : c.returns) {
                    one.opl_m *= unit.metres;
                    one.sigma_m *= unit.metres;
                }
            },
            list);
    }
}

void add_known_units(const SetupObservations& o, std::vector<Misreading>& list) {
    const std::array<LengthUnit, 3> of_distance{
        kLengthUnits[0], LengthUnit{"centimetres", 1e-2}, LengthUnit{"a path there and back", 0.5}};
    const std::array<LengthUnit, 1> of_gain{LengthUnit{"degrees", core::kPi / 180.0}};
    const auto add_units = [&](const KnownKey& key, std::span<const LengthUnit> units) {
        if (!(o.*key.value)) return;
        for (const LengthUnit& unit : units) {
            const auto convert = [&](SetupObservations& c) {
                (c.*key.value)->value *= unit.metres;
                (c.*key.value)->sigma *= unit.metres;
            };
            add(o,
                fmt::format("{} looks like {}", key.name, unit.name),
                fmt::format("{}.value={:.6g}", key.name, (o.*key.value)->value * unit.metres),
                convert,
                list);
        }
    };
    add_units(kKnownKeys[0], of_distance);
    add_units(kKnownKeys[1], of_gain);
    add_units(kKnownKeys[2], kLengthUnits);
}

// Only a camera can tell these: without it the wall's frame turns along.
void add_axes(const SetupObservations& o, std::vector<Misreading>& list) {
    if (!o.camera) return;
    const auto add_map = [&](const char* looks, const auto& map) {
        add(
            o,
            looks,
            "`commands` must be [u, v], to the right and upwards as the device sees the wall",
            [&](SetupObservations& c) {
                for (std::array<double, 2>& command : c.commands) map(command);
            },
            list);
    };
    add_map("u of the commands looks mirrored", [](auto& c) { c[0] = -c[0]; });
    add_map("v of the commands looks mirrored", [](auto& c) { c[1] = -c[1]; });
    add_map("u and v of the commands look exchanged", [](auto& c) { std::swap(c[0], c[1]); });
    add_map("u and v of the commands look exchanged and one of them mirrored", [](auto& c) {
        c = {-c[1], c[0]};
    });
}

/// How many commands at the beginning share u or v; 0 for scans that do not run row by row.
std::size_t row_length(const std::vector<std::array<double, 2>>& commands) {
    for (const std::size_t axis : {0U, 1U}) {
        const auto other = std::find_if(commands.begin(), commands.end(), [&](const auto& c) {
            return c[axis] != commands.front()[axis];
        });
        const auto length = static_cast<std::size_t>(other - commands.begin());
        if (length > 1 && length < commands.size() && commands.size() % length == 0) return length;
    }
    return 0;
}

// In which order the histograms may have been recorded instead.
void add_orders(const SetupObservations& o, std::vector<Misreading>& list) {
    const std::size_t count = o.returns.size();
    const auto add_order = [&](const char* looks, const auto& source) {
        add(
            o,
            fmt::format("the direct returns look recorded {}", looks),
            "`commands` must stand in the order of the histograms",
            [&](SetupObservations& c) {
                c.left_out.clear();
                for (std::size_t i = 0; i < count; ++i) c.returns[i] = o.returns[source(i)];
            },
            list);
    };
    add_order("from the last command to the first", [&](std::size_t i) { return count - 1 - i; });
    add_order("one command later", [&](std::size_t i) { return (i + 1) % count; });
    add_order("one command earlier", [&](std::size_t i) { return (i + count - 1) % count; });
    const std::size_t row = row_length(o.commands);
    if (row == 0) return;
    add_order("back and forth, every second row backwards", [&](std::size_t i) {
        return (i / row) % 2 == 0 ? i : i - i % row + (row - 1 - i % row);
    });
    add_order("column by column",
              [&](std::size_t i) { return (i % row) * (count / row) + i / row; });
}

}  // namespace

std::vector<Misreading> misreadings(const SetupObservations& o) {
    std::vector<Misreading> list;
    add_reversed_time(o, list);
    add_command_units(o, list);
    add_axis_units(o, list);
    add_known_units(o, list);
    add_axes(o, list);
    add_orders(o, list);
    return list;
}

}  // namespace calib
