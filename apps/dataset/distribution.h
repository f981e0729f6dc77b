// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/core/settings/json_fwd.h"
#include "renderer/core/settings/settings.h"

#include <map>
#include <string>
#include <vector>

namespace apps {

/// How a value of a recipe is drawn. In JSON: `{"uniform": [a, b]}`, `{"log_uniform": [a, b]}`,
/// `{"normal": [mean, deviation]}`, `{"integers": [first, last]}`, `{"choices": [x, y, ...]}`, and
/// anything else stands for itself.
struct Distribution {
    enum class Kind { Constant, Uniform, LogUniform, Normal, Integers, Choices };

    Kind kind = Kind::Constant;
    double first = 0.0;                ///< lower bound or mean
    double second = 0.0;               ///< upper bound or standard deviation
    std::vector<core::Json> values{};  ///< of Constant, one, and of Choices

    static Distribution constant(core::Json value) { return {Kind::Constant, 0, 0, {value}}; }
    static Distribution uniform(double low, double high) { return {Kind::Uniform, low, high}; }
    static Distribution integers(int low, int high) {
        return {Kind::Integers, double(low), double(high)};
    }
};

/// Throws core::Error naming `where` for a distribution that is none.
void read_value(const core::Json& json, const std::string& where, Distribution& distribution);
core::Json write_value(const Distribution& distribution);

/// A value of the distribution. Normal ones are cut off at three standard deviations.
core::Json draw(const Distribution& distribution, core::Rng& rng);

/// The same for one of numbers.
double draw_number(const Distribution& distribution, core::Rng& rng);

/// Values between which, or among which, all others lie: both ends, or every choice.
std::vector<core::Json> extremes(const Distribution& distribution);

/// Throws core::Error unless every value is a number within a range.
void check_range(const Distribution& distribution,
                 const core::Range& range,
                 const std::string& where);

/// Distributions by the dotted key of what they are for.
struct DrawTable : std::map<std::string, Distribution> {};
void read_value(const core::Json& json, const std::string& where, DrawTable& table);
core::Json write_value(const DrawTable& table);

}  // namespace apps

template <>
struct core::EnumNames<apps::Distribution::Kind> {
    static constexpr auto value = names_from_zero<apps::Distribution::Kind>(
        "constant", "uniform", "log_uniform", "normal", "integers", "choices");
};
